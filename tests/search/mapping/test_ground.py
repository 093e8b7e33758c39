"""The ground in reach: areas, distances and what lies ahead along an axis."""

import math

import numpy as np
import pytest

from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.search.mapping.elevation_map import Ground, UnseenGround, closed, nearest_cell, reach

SIDE_M = 0.1
SHAPE = (30, 50)
ORIGIN = (-1.0, -2.0)
AT = (0.55, -0.75)


def ground() -> Ground:
    cells = np.full(SHAPE, np.uint8(Cell.FREE))
    cells[:, 40:] = Cell.OCCUPIED
    grid = OccupancyGrid(cells, SIDE_M, ORIGIN)
    rows, columns = np.indices(SHAPE)
    heights = (0.1 * rows).astype(np.float32)
    none = np.zeros(SHAPE, dtype=bool)
    unseen = UnseenGround(none, np.full(SHAPE, np.nan, dtype=np.float32))
    free = cells == Cell.FREE
    return Ground(grid, heights, free, free & (columns < 38), none, 0.15, unseen, none)


def middles() -> tuple[np.ndarray, np.ndarray]:
    rows, columns = np.indices(SHAPE)
    return ORIGIN[0] + (columns + 0.5) * SIDE_M, ORIGIN[1] + (rows + 0.5) * SIDE_M


def test_an_area_is_that_of_its_cells():
    mask = np.zeros(SHAPE, dtype=bool)
    mask[3:8, 4:14] = True
    assert ground().area_m2(mask) == pytest.approx(0.5)


def test_distances_are_those_of_the_middles_of_cells():
    x, y = middles()
    expected = np.hypot(x - AT[0], y - AT[1])
    np.testing.assert_allclose(ground().distances_m(AT), expected, atol=1e-9)
    found = ground().positions(np.ones(SHAPE, dtype=bool))
    np.testing.assert_allclose(found, np.column_stack([x.ravel(), y.ravel()]))


@pytest.mark.parametrize("axis", [0.0, 0.7, 2.5, -1.9])
def test_what_lies_ahead_along_an_axis_does_so_by_its_direction(axis: float):
    x, y = middles()
    ahead_m, beside_m = ground().along(AT, axis)
    length, angle = np.hypot(x - AT[0], y - AT[1]), np.arctan2(y - AT[1], x - AT[0])
    np.testing.assert_allclose(ahead_m, length * np.cos(angle - axis), atol=1e-9)
    np.testing.assert_allclose(beside_m, length * np.abs(np.sin(angle - axis)), atol=1e-9)


def test_between_two_heights_lies_what_is_reached_there():
    mask = ground().between(0.95, 1.25)
    rows, columns = np.nonzero(mask)
    assert (set(rows.tolist()), columns.max()) == ({10, 11, 12}, 37)
    low_m, high_m = (float(np.float32(0.1 * row)) for row in (4, 6))
    assert set(np.nonzero(ground().between(low_m, high_m))[0].tolist()) == {4, 5, 6}


def test_reach_keeps_clear_of_what_is_not_free_by_round_distances():
    cells = np.full((21, 21), np.uint8(Cell.FREE))
    cells[10, 10] = Cell.OCCUPIED
    cells[:, 18] = Cell.OCCUPIED
    grid = OccupancyGrid(cells, SIDE_M, (0.0, 0.0))
    found = reach(grid, (0.25, 0.25), 0.25)
    rows, columns = np.indices(cells.shape)
    open_cells = (np.hypot(rows - 10, columns - 10) > 2.5) & (columns < 16)
    assert np.array_equal(found, open_cells)


def test_the_nearest_cell_is_found_only_near():
    mask = np.zeros(SHAPE, dtype=bool)
    mask[5, 7] = mask[6, 9] = True
    grid = ground().grid
    assert nearest_cell(mask, grid, (ORIGIN[0] + 0.95, ORIGIN[1] + 0.75)) == (6, 9)
    assert nearest_cell(mask, grid, (math.nextafter(3.9, 0.0), 0.9)) is None


def test_gaps_that_a_square_does_not_fit_into_are_closed():
    mask = np.zeros((11, 20), dtype=bool)
    mask[:, :6] = mask[:, 8:12] = mask[:, 16:] = True
    found = closed(mask, 3)
    assert found[5, 6:8].all()
    assert not found[5, 13:15].any()
