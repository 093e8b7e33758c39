"""What a cell costs around a robot is the same, however little of the map is priced."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.search.planning.config import PlanningConfig
from hypernav.search.planning.costmap import SURROUNDINGS_M, Costmap

SIDE_M, SHAPE, ORIGIN = 0.25, (80, 96), (-7.0, 3.0)
CLEARANCE_M = 0.22
FAR_M = 40.0
WALKED = np.random.default_rng(0).choice(
    np.array([Cell.FREE, Cell.UNKNOWN, Cell.OCCUPIED], np.uint8), SHAPE, p=(0.9, 0.05, 0.05)
)


def costmap(cells, robot, around=()) -> Costmap:
    grid = OccupancyGrid(cells, SIDE_M, ORIGIN)
    return Costmap.of(grid, PlanningConfig(), robot, CLEARANCE_M, around=around)


spots = st.tuples(st.floats(-7.0, 16.9), st.floats(3.0, 22.9))


@settings(deadline=None, max_examples=50)
@given(st.lists(spots, min_size=1, max_size=3))
def test_around_a_path_costs_are_those_of_the_whole_map(path):
    whole, part = costmap(WALKED, path[0]), costmap(WALKED, path[0], path)
    y, x = np.indices(whole.costs.shape)
    x, y = ORIGIN[0] + (x + 0.5) * SIDE_M, ORIGIN[1] + (y + 0.5) * SIDE_M
    low, high = np.min(path, axis=0), np.max(path, axis=0)
    away = np.maximum.reduce([low[0] - x, x - high[0], low[1] - y, y - high[1]])
    near = away <= SURROUNDINGS_M
    assert near.any()
    assert np.array_equal(part.costs[near], whole.costs[near])
    assert not part.costs[part.costs != whole.costs].any()


@pytest.mark.parametrize("row", [-1, 0, 1])
@pytest.mark.parametrize("column", [-1, 0, 1])
def test_off_the_map_the_nearest_cell_of_its_edge_is_open(row: int, column: int):
    free = np.full(SHAPE, np.uint8(Cell.FREE))
    robot = (5.0 + FAR_M * column, 13.0 + FAR_M * row)
    found = costmap(free, robot, [robot])
    nearest = np.clip(found.grid.cell_of(*robot), 0, np.array(found.costs.shape) - 1)
    assert found.is_open[tuple(nearest)]
