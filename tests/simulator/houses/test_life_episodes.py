"""Lives in generated buildings: what every one of them obeys."""

import math

import pytest

from hypernav.app.build.data.datasets import load_episodes, select
from hypernav.core.episode import lives_of
from hypernav.core.errors import EpisodeError
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import canonical
from hypernav.lab.datasets.building_splits import LIVES_PER_BUILDING, SPLITS
from hypernav.simulator.houses.building import Building
from hypernav.simulator.houses.episodes.building_truth import truth_of
from hypernav.simulator.houses.episodes.house_episodes import (
    GOALS_OF_A_LIFE,
    draw_lives,
    house_episodes,
)
from hypernav.simulator.houses.episodes.queries import RULES
from hypernav.simulator.houses.episodes.splits import load_split
from hypernav.simulator.houses.house_cache import cached_building
from hypernav.simulator.houses.random_stream import RandomStream

SEED = RandomStream(1, "test")


@pytest.fixture(
    scope="module",
    params=["houses", *(pytest.param(k, marks=pytest.mark.slow) for k in ("offices", "storeys"))],
)
def drawn(request):
    """A building's truth, its rules and its lives."""
    truth, rules = truth_of(cached_building(Building(request.param, 1))), RULES[request.param]
    return truth, rules, draw_lives(SEED, truth, rules)


def test_a_building_has_lives_of_five_to_ten_goals(drawn):
    _, _, lives = drawn
    assert len(lives) == LIVES_PER_BUILDING
    least, most = GOALS_OF_A_LIFE
    assert all(least <= len(life) <= most for life in lives)


def test_no_category_is_asked_for_twice_in_a_life(drawn):
    for life in drawn[2]:
        asked = [
            {canonical(i.label.category) for i in query.instances if i.label} for query, _ in life
        ]
        assert sum(map(len, asked)) == len(set().union(*asked))


def test_every_goal_can_be_reached_from_wherever_the_robot_may_be(drawn):
    truth, _, lives = drawn
    places = truth.places[:: max(len(truth.places) // 10, 1)].tolist()
    for text in {query.text for life in lives for query, _ in life}:
        region = truth.regions.of(Goal(text))
        assert all(math.isfinite(region.distance(*place)) for place in places)


def test_a_goal_begins_where_the_one_before_is_at_the_distance_of_the_rules(drawn):
    truth, rules, lives = drawn
    (life, *_) = lives
    regions = [truth.regions.of(Goal(query.text)) for query, _ in life]
    for region, (_, start) in zip(regions, life, strict=True):
        distance = region.distance(*start.pose.xy, start.floor_z)
        assert distance == start.geodesic_m
        assert rules.least_m <= distance <= rules.most_m
    for region, (_, start) in zip(regions, life[1:], strict=False):
        assert region.distance(*start.pose.xy, start.floor_z) < 0.05


def test_categories_and_phrases_are_asked_for(drawn):
    texts = {query.text for life in drawn[2] for query, _ in life}
    assert texts & set(drawn[1].categories)
    assert texts - set(drawn[1].categories)


def test_the_same_building_has_the_same_lives():
    building = Building("houses", 2)
    scene = cached_building(building)
    drawn = house_episodes(scene, building, "lives")
    assert len({(e.info or {})["life"] for e in drawn.episodes}) == LIVES_PER_BUILDING
    assert house_episodes(scene, building, "lives") == drawn


@pytest.mark.slow
def test_a_split_visits_buildings_in_turn_life_by_life(tmp_path):
    split = load_split("houses-life-train", numbers=range(5000, 5002), count=3, cache=tmp_path)
    lives = [(e.info or {})["life"] for e in split.episodes]
    assert list(dict.fromkeys(lives)) == ["5000-0", "5001-0", "5000-1"]
    assert split.episodes[0].episode_id == "5000-0.1"
    with pytest.raises(EpisodeError, match="9 lives: houses-life-train has 1 to 8"):
        load_split("houses-life-train", numbers=range(5000, 5002), count=9, cache=tmp_path)


def test_positions_of_a_split_of_lives_are_those_of_lives():
    episodes = load_episodes("houses-life-train#5000:5001")
    lives = lives_of(episodes)
    assert [life.key[1] for life in lives] == [f"5000-{k}" for k in range(4)]
    chosen = select(episodes, part="1:3")
    assert chosen == [*lives[1].episodes, *lives[2].episodes]


def test_a_life_of_some_goals_keeps_their_order():
    episodes = load_episodes("houses-life-train#5000:5001")
    first = lives_of(episodes)[0].episodes
    names = f"{first[0].goal.text},{first[3].goal.text}"
    part = select(episodes, part="0:1", goals=names)
    assert part == [first[0], first[3]]
    assert len(lives_of(part)) == 1


@pytest.mark.freeze
@pytest.mark.parametrize("name", [name for name, split in SPLITS.items() if split.has_lives])
def test_every_split_has_a_hundred_lives(name):
    lives = lives_of(load_episodes(name))
    assert len(lives) == SPLITS[name].episodes == 100
    assert all(5 <= len(life.episodes) <= 10 for life in lives)
