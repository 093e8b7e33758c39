"""A building in three dimensions on its page."""

from contextlib import closing

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.simulator.houses.building import BUILTIN_HOUSE, house
from hypernav.simulator.houses.export.building_space import building_space, spread
from hypernav.simulator.houses.generator import storeys_of
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer
from hypernav.simulator.worlds.scenes.scene import Scene

POINTS = st.lists(st.tuples(st.floats(-9.0, 9.0), st.floats(-9.0, 9.0)), min_size=1, max_size=40)


@given(POINTS)
def test_positions_are_some_of_the_points_and_near_to_all(
    points: list[tuple[float, float]],
) -> None:
    chosen = spread(np.array(points))
    assert {tuple(one) for one in chosen.tolist()} <= set(points)
    away = np.linalg.norm(np.array(points)[:, None] - chosen[None], axis=2).min(axis=1)
    assert away.max() <= 1.5 * np.sqrt(2.0)


@pytest.mark.slow
def test_every_object_is_in_the_view_and_the_camera_sees_the_rooms(builtin_scene: Scene) -> None:
    storeys = storeys_of(house(BUILTIN_HOUSE))
    told = list[tuple[int, int]]()
    with closing(CpuRenderer(builtin_scene)) as renderer:
        space = building_space(builtin_scene, storeys, renderer, lambda *done: told.append(done))
    assert told[-1][0] == told[-1][1] == len(told)
    names = {box["words"] for box in space["boxes"]}
    assert names == {one.label.category for one in builtin_scene.instances if one.label}
    assert {"bed", "sofa", "door", "window"} <= names
    assert {box["floor"] for box in space["boxes"]} == {1}
    assert len(space["floors"]) == 1
    assert space["cloud"]["counts"][1] > 50_000
