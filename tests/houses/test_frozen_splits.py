"""The frozen splits are what was measured: every building, its episodes, and their order."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from frozen_splits import (
    episodes_digest,
    geometry_digest,
    record,
    recorded,
    sample_of,
    view_points_of,
)
from hypernav.build.data.datasets import fingerprint, load_episodes
from hypernav.houses.building import BUILTIN_HOUSE, Building, house
from hypernav.houses.episodes.house_episodes import house_episodes
from hypernav.houses.episodes.splits import SPLITS, load_split
from hypernav.houses.generator import generate

FROZEN = [name for name in SPLITS if not name.endswith("-train")]
SAMPLED = [(name, number) for name in FROZEN for number in sample_of(SPLITS[name])[::2]]
ALL = [(name, number) for name in FROZEN for number in SPLITS[name].numbers]
NOISE_M = 2e-5


@pytest.mark.slow
@pytest.mark.parametrize(("name", "number"), SAMPLED)
def test_some_buildings_of_every_frozen_split_stand_as_they_stood(name, number):
    expected = recorded()[name]["buildings"][str(number)]
    assert geometry_digest(generate(Building(SPLITS[name].kind, number))) == expected["geometry"]


@pytest.mark.slow
@pytest.mark.parametrize("name", FROZEN)
def test_a_building_of_every_frozen_split_has_the_episodes_that_were_measured(name, tmp_path):
    check(name, sample_of(SPLITS[name])[1], tmp_path)


@pytest.mark.freeze
@pytest.mark.parametrize(("name", "number"), ALL)
def test_every_building_of_the_frozen_splits_is_what_was_measured(name, number):
    check(name, number, None)


@pytest.mark.freeze
@pytest.mark.parametrize("name", FROZEN)
def test_a_frozen_split_has_the_episodes_that_were_measured_in_their_order(name):
    assert fingerprint(load_episodes(name)) == recorded()[name]["fingerprint"]


def check(name, number, folder):
    """Check a building against its record; of view points, but for rays that graze an edge."""
    expected = recorded()[name]["buildings"][str(number)]
    now = record(SPLITS[name], number, folder)
    assert (now["geometry"], now["episodes"]) == (expected["geometry"], expected["episodes"])
    (count, *middle), (was_count, *was_middle) = now["view_points"], expected["view_points"]
    assert count == pytest.approx(was_count, rel=1e-3)
    assert middle == pytest.approx(was_middle, abs=0.005)


@pytest.mark.freeze
@pytest.mark.parametrize("name", ["storeys-val", "storeys-test"])
def test_a_third_of_the_goals_is_on_the_storey_of_the_start_a_third_above_and_a_third_below(name):
    where = Counter((e.info or {})["goal_is"] for e in load_split(name).episodes)
    assert where == {"same": 100, "above": 100, "below": 100}


@pytest.fixture(scope="module")
def dataset(builtin_scene):
    return house_episodes(builtin_scene, house(BUILTIN_HOUSE), "categories")


def test_the_last_bits_of_positions_do_not_matter(builtin_scene):
    noise = np.random.default_rng(0).uniform(-NOISE_M, NOISE_M, builtin_scene.vertices.shape)
    noisy = replace(builtin_scene, vertices=(builtin_scene.vertices + noise).astype(np.float32))
    assert geometry_digest(noisy) == geometry_digest(builtin_scene)


def test_a_chair_that_moved_by_a_centimetre_matters(builtin_scene):
    (chair, *_) = (i.id for i in builtin_scene.instances if i.label and i.label.category == "chair")
    vertices = builtin_scene.vertices.copy()
    vertices[np.unique(builtin_scene.faces[builtin_scene.face_instance == chair])] += (0.01, 0, 0)
    moved = replace(builtin_scene, vertices=vertices)
    assert geometry_digest(moved) != geometry_digest(builtin_scene)


def test_another_name_or_colour_matters(builtin_scene):
    (first, *others) = builtin_scene.instances
    renamed = replace(builtin_scene, instances=(replace(first, name="another"), *others))
    (paint, *rest) = builtin_scene.materials
    painted = replace(builtin_scene, materials=(replace(paint, color=(0.0, 0.5, 1.0)), *rest))
    assert len(set(map(geometry_digest, (builtin_scene, renamed, painted)))) == 3


@pytest.mark.parametrize(
    "change",
    [
        lambda one: {"start_position": (one.start_position[0] + 0.01, *one.start_position[1:])},
        lambda one: {"start_rotation": (0.0, 0.6, 0.0, 0.8)},
        lambda one: {"object_category": "another"},
        lambda one: {
            "info": one.info | {"geodesic_distance": one.info["geodesic_distance"] + 0.01}
        },
    ],
)
def test_another_start_goal_or_shortest_path_matters(dataset, change):
    (first, *others) = dataset.episodes
    changed = dataset.model_copy(
        update={"episodes": [first.model_copy(update=change(first)), *others]}
    )
    assert episodes_digest(changed) != episodes_digest(dataset)


def test_the_view_points_of_all_goals_count(dataset, builtin_scene):
    count, *middle = view_points_of(dataset, builtin_scene)
    goals = dict(list(dataset.goals_by_category.items())[:3])
    some, *_ = view_points_of(
        dataset.model_copy(update={"goals_by_category": goals}), builtin_scene
    )
    assert 0 < some < count
    low, high = builtin_scene.vertices.min(axis=0), builtin_scene.vertices.max(axis=0)
    assert low[0] < middle[0] < high[0]
