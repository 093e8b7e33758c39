"""Laws of the houses' episodes, on few houses; on whole splits in the frozen tests."""

import math

import numpy as np
import pytest

from box_houses import box_house
from box_scenes import room_boxes, scene_of
from certainty import certain
from hypernav.core.errors import EpisodeError
from hypernav.core.goal import Goal
from hypernav.lab.datasets.building_splits import EPISODES_PER_HOUSE, EPISODES_PER_ROUND, SPLITS
from hypernav.lab.datasets.habitat_files import read_episodes, write_episodes
from hypernav.lab.datasets.habitat_format import pose_from_habitat
from hypernav.simulator.houses.building import BUILTIN_HOUSE, NOUNS, Building, house
from hypernav.simulator.houses.episodes import splits
from hypernav.simulator.houses.episodes.building_truth import HouseGroundTruth
from hypernav.simulator.houses.episodes.house_episodes import house_episodes, with_view_points
from hypernav.simulator.houses.episodes.queries import CATEGORIES, HABITAT_CATEGORIES, RULES
from hypernav.simulator.houses.episodes.splits import difficulty, load_split
from hypernav.simulator.houses.generator import generate

HOUSE = BUILTIN_HOUSE
STYLES = ("categories", "phrases")


@pytest.fixture(scope="module")
def truth(builtin_scene):
    return HouseGroundTruth.of(builtin_scene)


@pytest.fixture(scope="module", params=STYLES)
def dataset(builtin_scene, request):
    return with_view_points(
        house_episodes(builtin_scene, house(HOUSE), request.param), builtin_scene
    )


@pytest.fixture
def box_houses(monkeypatch):
    """Splits of houses made of boxes, which take no time to build."""
    monkeypatch.setattr(splits, "cached_building", box_house)


def check_laws(dataset, truth):
    """Check that every start is walkable and as far from the goal as the file says."""
    rules = RULES[Building.named(truth.scene.name).kind]
    regions = {e.object_category: truth.regions.of(e.goal) for e in dataset.episodes}
    for episode in dataset.episodes:
        pose, floor_z = pose_from_habitat(episode.start_position, episode.start_rotation)
        assert truth.walkable.component_of(pose.x, pose.y) == 0
        assert floor_z == pytest.approx(truth.walkable.height_at(pose.x, pose.y), abs=1e-4)
        region = regions[episode.object_category]
        assert truth.wide_area.component_of(pose.x, pose.y) == 0
        assert truth.touches_wide_area(region.view_points)
        distance = region.distance(pose.x, pose.y)
        assert rules.least_m <= distance <= rules.most_m
        assert episode.info["geodesic_distance"] == pytest.approx(distance, rel=0.01)
        assert 0.0 <= episode.info["euclidean_distance"] <= episode.info["geodesic_distance"]
        goals = {goal.object_id: goal for goal in dataset.goals_of(episode)}
        reached = {i.id for i in region.instances if len(truth.regions.view_points(i))}
        assert set(goals) == reached
        assert episode.info["closest_goal_object_id"] in reached
        assert all(goal.view_points for goal in goals.values())


def test_starts_and_goals_hold_what_the_file_says(dataset, truth):
    assert len(dataset.episodes) == EPISODES_PER_HOUSE
    check_laws(dataset, truth)


def test_a_file_has_the_very_view_points_of_the_scene(dataset, truth):
    for episode in {e.object_category: e for e in dataset.episodes}.values():
        region = truth.regions.of(episode.goal)
        kept = dataset.view_points_of(episode)
        assert np.array_equal(np.unique(kept, axis=0), region.view_points)


def test_view_points_look_at_their_object(dataset):
    goals = [goal for found in dataset.goals_by_category.values() for goal in found]
    for goal in goals:
        for point in goal.view_points[:3]:
            pose, _ = pose_from_habitat(point.agent_state.position, point.agent_state.rotation)
            bearing = math.atan2(-goal.position[2] - pose.y, goal.position[0] - pose.x)
            assert math.cos(bearing - pose.yaw) > 0.999


@pytest.mark.slow
def test_the_same_house_gives_the_same_bytes(dataset, builtin_scene, tmp_path):
    style = "phrases" if "vocabulary" in dataset.episodes[0].info else "categories"
    write_episodes(dataset, tmp_path / "a.json.gz")
    again = with_view_points(house_episodes(builtin_scene, house(HOUSE), style), builtin_scene)
    write_episodes(again, tmp_path / "b.json.gz")
    assert (tmp_path / "a.json.gz").read_bytes() == (tmp_path / "b.json.gz").read_bytes()


def test_what_is_written_is_what_is_read(dataset, tmp_path):
    path = tmp_path / "house.json.gz"
    write_episodes(dataset, path)
    assert read_episodes(path) == dataset


def test_categories_are_spread_evenly(builtin_scene):
    goals = difficulty(house_episodes(builtin_scene, house(HOUSE), "categories")).goals
    assert set(goals) <= set(CATEGORIES)
    assert max(goals.values()) - min(goals.values()) <= 1
    labels = [i.label for i in builtin_scene.instances if i.label]
    held = {c for c in HABITAT_CATEGORIES if any(x.satisfies(Goal(c)) for x in labels)}
    assert len(held & set(goals)) >= 4


def test_phrases_use_seen_synonymous_and_unseen_names_alike(builtin_scene):
    dataset = house_episodes(builtin_scene, house(HOUSE), "phrases")
    found = difficulty(dataset)
    assert set(found.vocabulary) == {"seen", "synonym", "unseen"}
    assert min(found.vocabulary.values()) >= EPISODES_PER_HOUSE // 4
    assert found.descriptions >= EPISODES_PER_HOUSE // 5
    unseen = {
        e.object_category for e in dataset.episodes if certain(e.info)["vocabulary"] == "unseen"
    }
    assert unseen.isdisjoint(CATEGORIES)


def test_a_description_is_true_of_some_and_false_of_others_of_the_name(builtin_scene):
    dataset = house_episodes(builtin_scene, house(HOUSE), "phrases")
    labels = {i.id: i.label for i in builtin_scene.instances if i.label}
    described = [e for e in dataset.episodes if certain(e.info)["is_description"]]
    for episode in described:
        true = {number for number, label in labels.items() if label.satisfies(episode.goal)}
        missed = certain(episode.info)["near_miss_object_ids"]
        assert true
        assert missed
        assert true.isdisjoint(missed)
        assert (len(true) == 1) == episode.object_category.startswith("the ")


def test_a_house_without_anything_to_find_says_so():
    empty = scene_of(*room_boxes(6.0, 4.0), name="houses:7")
    for style in STYLES:
        with pytest.raises(EpisodeError, match="houses:7"):
            house_episodes(empty, house(7), style)


def test_nothing_begins_or_ends_behind_a_gap_that_the_robot_hardly_fits_through():
    walls = [(None, (7.0, 0.0, 0.0), (7.1, 1.8, 2.5)), (None, (7.0, 2.25, 0.0), (7.1, 4.0, 2.5))]
    objects = [
        ("bed", (0.2, 0.2, 0.0), (1.2, 1.8, 0.5)),
        ("chair", (9.4, 0.1, 0.0), (9.8, 0.5, 0.9)),
    ]
    scene = scene_of(*room_boxes(10.0, 4.0), *walls, *objects, name="houses:7")
    truth = HouseGroundTruth.of(scene)
    assert truth.walkable.component_of(8.0, 2.0) == 0
    assert truth.wide_area.component_of(8.0, 2.0) != 0
    episodes = house_episodes(scene, house(7), "categories").episodes
    assert {episode.object_category for episode in episodes} == {"bed"}
    starts = [pose_from_habitat(e.start_position, e.start_rotation)[0] for e in episodes]
    assert max(start.x for start in starts) < 7.0


@pytest.mark.parametrize(
    "building",
    [Building("offices", 3), pytest.param(Building("shops", 2), marks=pytest.mark.slow)],
)
def test_episodes_of_other_buildings_ask_for_what_does_not_stand_everywhere(building):
    scene = generate(building)
    dataset = house_episodes(scene, building, "categories")
    check_laws(with_view_points(dataset, scene), HouseGroundTruth.of(scene))
    assert len(dataset.episodes) == EPISODES_PER_HOUSE
    goals = {e.object_category for e in dataset.episodes}
    assert goals <= set(RULES[building.kind].categories)
    assert len(goals) >= 6
    distances = [certain(e.info)["geodesic_distance"] for e in dataset.episodes]
    assert np.median(distances) > 5.0


def test_rooms_on_a_path_are_counted_by_their_floors():
    floors = [(None, (0.0, 0.0, -0.1), (3.0, 4.0, 0.0)), (None, (3.0, 0.0, -0.1), (6.0, 4.0, 0.0))]
    scene = scene_of(*room_boxes(6.0, 4.0), *floors)
    for instance, name in zip(scene.instances[-2:], ("floor_hall_1", "floor_bath_1"), strict=True):
        object.__setattr__(instance, "name", name)
    truth = HouseGroundTruth.of(scene)
    assert truth.rooms_on([(1.0, 1.0), (2.0, 2.0)]) == 1
    assert truth.rooms_on([(1.0, 1.0), (5.0, 1.0), (1.0, 2.0)]) == 2
    assert truth.rooms_on([(7.0, 7.0), (8.0, 7.0)]) == 0


@pytest.mark.parametrize("kind", NOUNS)
def test_the_training_split_of_a_kind_shares_no_building_with_the_others(kind):
    own = [split for split in SPLITS.values() if split.kind == kind]
    (train,) = [split for split in own if split.is_open]
    for split in own:
        if split is not train:
            assert not set(split.numbers) & set(train.numbers)
            with pytest.raises(EpisodeError, match=f"belong to {split.name}"):
                train.check(split.numbers)


def test_splits_share_no_house():
    val, ovon, train = SPLITS["houses-val"], SPLITS["houses-ovon"], SPLITS["houses-train"]
    assert len(val.numbers) == len(ovon.numbers) == 36
    assert val.episodes == ovon.episodes == 1000
    assert not set(val.numbers) & set(ovon.numbers)
    assert not set(train.numbers) & (set(val.numbers) | set(ovon.numbers))
    for taken in (range(999, 1001), range(1035, 1036), range(2000, 2001), range(0, 5000)):
        with pytest.raises(EpisodeError, match="belong to houses-"):
            train.check(taken)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"name": "houses-vall"}, "did you mean 'houses-val'"),
        ({"name": "nothing"}, "houses-train"),
        ({"name": "houses-val", "numbers": range(999, 1001)}, "1000:1036"),
        ({"name": "houses-val", "numbers": range(1004, 1004)}, "FIRST < END"),
        ({"name": "houses-val", "count": 1001}, "1 to 1000"),
        ({"name": "houses-val", "count": 0}, "1 to 1000"),
        ({"name": "houses-train", "numbers": range(5, 7), "count": 57}, "1 to 56"),
    ],
)
def test_what_a_split_does_not_have_is_said_before_any_house_is_built(arguments, words):
    with pytest.raises(EpisodeError, match=words):
        load_split(**arguments)


def test_a_split_visits_houses_in_rounds_and_subsets_agree(box_houses, tmp_path):
    seen = []
    whole = load_split(
        "houses-train",
        numbers=range(5, 8),
        cache=tmp_path,
        progress=lambda *told: seen.append(told),
    )
    assert seen == [(0, 3), (1, 3), (2, 3), (3, 3)]
    assert len(whole.episodes) == len({e.episode_id for e in whole.episodes}) == 84
    scenes = [e.scene_id for e in whole.episodes[: 3 * EPISODES_PER_ROUND]]
    assert scenes == [f"houses:{number}" for number in (5, 6, 7) for _ in range(EPISODES_PER_ROUND)]
    some = load_split("houses-train", numbers=range(5, 8), count=6, cache=tmp_path)
    assert some.episodes == whole.episodes[:6]
    assert set(some.goals_by_category) == {e.goals_key() for e in some.episodes}
    one = load_split("houses-train", numbers=range(6, 7), cache=tmp_path)
    assert one.episodes == [e for e in whole.episodes if e.scene_id == "houses:6"]
    numbers = one.category_to_task_category_id
    assert numbers == whole.category_to_task_category_id == {c: k for k, c in enumerate(CATEGORIES)}
    assert list(numbers)[:6] == list(HABITAT_CATEGORIES)


def test_a_broken_cache_file_is_made_again(box_houses, tmp_path, monkeypatch):
    fresh = splits.cached_episodes(house(5), "categories", tmp_path)
    (path,) = tmp_path.rglob("*.json.gz")
    good = path.read_bytes()
    path.write_bytes(good[: len(good) // 2])
    assert splits.cached_episodes(house(5), "categories", tmp_path) == fresh
    assert path.read_bytes() == good
    monkeypatch.setattr(splits, "cached_building", None)
    assert splits.cached_episodes(house(5), "categories", tmp_path) == fresh


def test_a_cache_that_cannot_be_written_is_done_without(box_houses, tmp_path):
    occupied = tmp_path / "file"
    occupied.write_text("not a folder")
    assert splits.cached_episodes(house(5), "categories", occupied).episodes


@pytest.mark.freeze
@pytest.mark.parametrize(
    "name", [name for name, one in SPLITS.items() if not one.is_open and not one.has_lives]
)
def test_the_whole_split_obeys_the_laws(name):
    split = SPLITS[name]
    dataset = load_split(name)
    assert len(dataset.episodes) == split.episodes
    buildings = [Building(split.kind, number) for number in split.numbers]
    assert {e.scene_id for e in dataset.episodes} == {building.scene for building in buildings}
    for building in buildings:
        own = [e for e in dataset.episodes if e.scene_id == building.scene]
        part = dataset.model_copy(update={"episodes": own})
        scene = generate(building)
        check_laws(with_view_points(part, scene), HouseGroundTruth.of(scene))
