"""The way to a remembered thing leads to where it is in sight, around what hides it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from box_views import CAMERA, room, view_of
from hypernav.core.embodiment import CameraConfig, Embodiment
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.agents.recall import _filled, path_to_thing, path_to_view
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.reachable_area import ReachableArea
from hypernav.search.mapping.top_down_map import TopDownMap
from hypernav.search.memory.thing import Thing

SOFA = ((4.0, 1.2, 0.0), (4.6, 2.4, 0.8))
WALL = ((3.0, 2.6, 0.0), (5.4, 2.75, 2.0))
VIEWS = ((1.5, 1.8, 0.9), (6.5, 1.8, 0.8), (4.3, 4.6, 0.5))
THING = Thing(0, "sofa", 0.9, SOFA[0], SOFA[1], VIEWS, 900.0, 1, 1)


@pytest.fixture(scope="module")
def floor_map() -> TopDownMap:
    seen = TopDownMap(
        MappingConfig(), Embodiment(camera=CameraConfig(width=CAMERA.width, height=CAMERA.height))
    )
    for x, y in ((1.0, 1.0), (4.3, 4.5), (7.0, 1.5), (1.0, 4.5), (7.0, 4.5)):
        for k in range(6):
            seen.integrate(view_of([*room(8.0, 6.0), SOFA, WALL], Pose2(x, y, k * math.pi / 3.0)))
    return seen


def way_from(floor_map: TopDownMap, robot: Pose2):
    reach = ReachableArea.of(floor_map.grid, robot, MappingConfig(), 0.2)
    return path_to_thing(THING, floor_map, reach, robot), reach


@pytest.mark.parametrize(
    "robot", [Pose2(4.3, 4.0, 0.0), Pose2(1.5, 1.5, 0.0), Pose2(6.8, 3.5, 0.0)]
)
def test_it_leads_beside_the_thing_to_where_nothing_hides_it(floor_map: TopDownMap, robot: Pose2):
    ((x, y), path_m), reach = way_from(floor_map, robot)
    nearest = (min(max(x, SOFA[0][0]), SOFA[1][0]), min(max(y, SOFA[0][1]), SOFA[1][1]))
    assert 0.0 < math.dist((x, y), nearest) <= 1.0 + 1e-6
    assert path_m >= math.dist(robot.xy, (x, y)) - 0.15
    row, column = reach.grid.cell_of(x, y)
    assert path_m == pytest.approx(float(reach.travel_m[row, column]))
    line = np.linspace(0.0, 1.0, 50)[:, None] * (np.array(nearest) - (x, y)) + (x, y)
    crosses = (line[:, 1] > WALL[0][1]) & (line[:, 1] < WALL[1][1])
    crosses &= (line[:, 0] > WALL[0][0]) & (line[:, 0] < WALL[1][0])
    assert not crosses.any()
    assert y < WALL[0][1] or x < WALL[0][0] or x > WALL[1][0]


def test_what_cannot_be_come_near_is_gone_to_from_the_nearest_place_in_sight(floor_map: TopDownMap):
    robot = Pose2(1.5, 1.5, 0.0)
    reach = ReachableArea.of(floor_map.grid, robot, MappingConfig(), 0.2)
    y, x = (side + 0.5 for side in np.indices(reach.travel_m.shape))
    size, (left, bottom) = reach.grid.resolution_m, reach.grid.origin
    off = [
        np.maximum(SOFA[0][k] - at, at - SOFA[1][k])
        for k, at in ((0, left + size * x), (1, bottom + size * y))
    ]
    away_m = np.hypot(*np.maximum(off, 0.0))
    fenced = away_m <= 1.3
    far = replace(
        reach,
        reachable=np.where(fenced, 0, reach.reachable).astype(np.uint8),
        travel_m=np.where(fenced, np.inf, reach.travel_m).astype(np.float32),
    )
    at, path_m = path_to_thing(THING, floor_map, far, robot)
    cell = reach.grid.cell_of(*at)
    assert far.reachable[cell]
    assert 1.3 < away_m[cell] <= 4.0
    assert path_m == pytest.approx(float(reach.travel_m[cell] + away_m[cell]))
    assert at[0] < SOFA[0][0]  # on the side that the robot comes from


def test_what_it_was_seen_from_is_as_far_as_the_path_or_twice_the_straight_line(floor_map):
    robot = Pose2(1.0, 1.0, 0.0)
    reach = ReachableArea.of(floor_map.grid, robot, MappingConfig(), 0.2)
    at, path_m = path_to_view(THING, reach, robot)
    assert at == THING.seen_from == (1.5, 1.8)
    assert math.dist(robot.xy, at) - 0.1 <= path_m <= 2.0 * math.dist(robot.xy, at)


@given(st.tuples(*[st.floats(0.3, 6.0)] * 2), st.tuples(*[st.floats(0.01, 2.0)] * 2))
def test_a_thing_on_the_floor_fills_the_cells_under_it_and_none_a_cell_away(corner, sides):
    low, high = np.array(corner), np.array(corner) + sides
    thing = replace(THING, low=(*corner, 0.0), high=(*high.tolist(), 0.8))
    grid = OccupancyGrid(np.zeros((180, 180), np.uint8), 0.05, (0.0, 0.0))
    middles = grid.centres_of(np.argwhere(np.ones_like(grid.cells)))
    under = ((middles >= low) & (middles <= high)).all(axis=1)
    beyond = np.maximum(low - middles, middles - high).max(axis=1)
    filled = grid.mask_of(_filled(thing, grid)).ravel()
    assert filled[under].all()
    assert beyond[filled].max() < 1.5 * 0.05 + 1e-9
