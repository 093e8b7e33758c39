"""The shipped splits are what was measured: every building, its episodes, and their order."""

import json
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from ship_splits import record, view_points_of

from hypernav.app.build.data.datasets import load_episodes
from hypernav.core.errors import SceneError
from hypernav.lab.datasets.building_splits import SPLITS
from hypernav.lab.datasets.shipped import SHIPPED, check_geometry, shipped_buildings, shipped_split
from hypernav.simulator.houses.building import BUILTIN_HOUSE, Building, house
from hypernav.simulator.houses.episodes.house_episodes import house_episodes
from hypernav.simulator.houses.episodes.splits import load_split
from hypernav.simulator.houses.generator import generate
from hypernav.simulator.houses.house_cache import geometry_digest, in_thousandths

FROZEN = [name for name in SPLITS if not name.endswith("-train")]
ALL = [(name, number) for name in FROZEN for number in SPLITS[name].numbers]
SAMPLED = [one for one in ALL if one[1] in (SPLITS[one[0]].numbers[0], SPLITS[one[0]].numbers[-1])]
NOISE_M = 2e-5


def test_every_frozen_split_is_shipped_whole():
    assert set(FROZEN) <= {path.name.removesuffix(".json.gz") for path in SHIPPED.glob("*.gz")}
    for name in FROZEN:
        episodes, split = load_episodes(name), SPLITS[name]
        units = {one.life or one.key for one in episodes}
        assert len(units) == split.episodes
        assert {one.scene_id for one in episodes} == {f"{split.kind}:{k}" for k in split.numbers}
        assert set(shipped_buildings()[name]) == set(map(str, split.numbers))


def test_a_building_that_is_drawn_differently_is_refused():
    (number, recorded), *_ = shipped_buildings()["houses-val"].items()
    check_geometry("houses", int(number), recorded["geometry"])
    check_geometry("shops", 3999, "0" * 16)
    with pytest.raises(SceneError, match=f"houses:{number} is drawn differently here.*houses-val"):
        check_geometry("houses", int(number), "0" * 16)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "number"), SAMPLED)
def test_some_buildings_of_every_frozen_split_stand_as_they_stood(name, number):
    expected = shipped_buildings()[name][str(number)]["geometry"]
    assert geometry_digest(generate(Building(SPLITS[name].kind, number))) == expected


@pytest.mark.slow
@pytest.mark.parametrize("name", FROZEN)
def test_a_building_of_every_frozen_split_has_the_episodes_that_were_measured(name, tmp_path):
    numbers = SPLITS[name].numbers
    check(name, numbers[len(numbers) // 2], tmp_path)


@pytest.mark.freeze
@pytest.mark.parametrize(("name", "number"), ALL)
def test_every_building_of_the_frozen_splits_is_what_was_measured(name, number):
    check(name, number, None)


def check(name, number, cache):
    """Check a building; of view points, but for rays that graze an edge."""
    expected, now = shipped_buildings()[name][str(number)], record(name, number, cache)
    assert now["geometry"] == expected["geometry"]
    (count, *middle), (was_count, *was_middle) = now["view_points"], expected["view_points"]
    assert count == pytest.approx(was_count, rel=1e-3)
    assert middle == pytest.approx(was_middle, abs=0.005)
    scene, shipped = f"{SPLITS[name].kind}:{number}", shipped_split(name)
    assert shipped is not None
    drawn = load_split(name, numbers=range(number, number + 1), cache=cache)
    kept = [one for one in shipped.episodes if one.scene_id == scene]
    assert in_steps(drawn.episodes[: len(kept)]) == in_steps(kept)
    for key in {one.goals_key() for one in kept}:
        assert in_steps(drawn.goals_by_category[key]) == in_steps(shipped.goals_by_category[key])


def in_steps(models):
    """What models of a data set hold, with numbers in thousandths."""
    return json.loads(
        json.dumps([one.model_dump() for one in models]),
        parse_float=lambda text: int(in_thousandths(np.array([float(text)]))[0]),
    )


@pytest.mark.parametrize("name", ["storeys-val", "storeys-test"])
def test_a_third_of_the_goals_is_on_the_storey_of_the_start_a_third_above_and_a_third_below(name):
    shipped = shipped_split(name)
    assert shipped is not None
    where = Counter((e.info or {})["goal_is"] for e in shipped.episodes)
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


def test_the_view_points_of_all_goals_count(dataset, builtin_scene):
    count, *middle = view_points_of(dataset, builtin_scene)
    goals = dict(list(dataset.goals_by_category.items())[:3])
    some, *_ = view_points_of(
        dataset.model_copy(update={"goals_by_category": goals}), builtin_scene
    )
    assert 0 < some < count
    low, high = builtin_scene.vertices.min(axis=0), builtin_scene.vertices.max(axis=0)
    assert low[0] < middle[0] < high[0]
