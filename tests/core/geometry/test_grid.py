import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from hypernav.core.geometry.grid import Cell, OccupancyGrid


def grid_of(cells, origin=(-1.0, 2.0), resolution=0.05):
    return OccupancyGrid(np.array(cells, dtype=np.uint8), resolution, origin)


@given(st.integers(0, 39), st.integers(0, 59))
def test_a_cell_and_its_centre_belong_together(row, column):
    grid = grid_of(np.zeros((40, 60)))
    assert grid.cell_of(*grid.centre_of(row, column)) == (row, column)
    centres = grid.centres_of(np.array([[row, column]]))
    np.testing.assert_array_equal(grid.cells_of(centres), [[row, column]])


def test_rows_run_along_y_and_columns_along_x():
    grid = grid_of(np.zeros((4, 4)), origin=(0.0, 0.0), resolution=1.0)
    assert grid.cell_of(2.5, 1.5) == (1, 2)


def test_outside_the_grid_nothing_is_known():
    grid = grid_of([[Cell.FREE]], origin=(0.0, 0.0), resolution=1.0)
    assert grid.state_at(0.5, 0.5) is Cell.FREE
    assert grid.state_at(-0.5, 0.5) is Cell.UNKNOWN
    assert grid.state_at(0.5, 7.0) is Cell.UNKNOWN


@given(st.integers(-3, 7), st.integers(-3, 9))
def test_a_grid_has_the_cells_that_can_be_looked_up_without_counting_from_its_end(row, column):
    grid = grid_of(np.arange(20).reshape(4, 5))
    assert grid.inside(row, column) == (row in range(4) and column in range(5))
    assert grid.contains(np.array([[row, column], [0, 0]])).tolist() == [
        grid.inside(row, column),
        True,
    ]


@given(st.lists(st.tuples(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0)), max_size=8))
def test_a_mask_holds_exactly_the_cells_of_its_points(points):
    grid = grid_of(np.zeros((5, 4)), origin=(-1.0, -2.0), resolution=0.5)
    at = np.array(points).reshape(-1, 2)
    mask = grid.mask_of(at)
    inside = {cell for one in points if grid.inside(*(cell := grid.cell_of(*one)))}
    assert set(map(tuple, np.argwhere(mask).tolist())) == inside
    held = [grid.inside(*grid.cell_of(*one)) for one in points]
    assert grid.picked(mask, at).tolist() == held


def test_of_no_cells_none_is_on_the_grid():
    assert grid_of([[0]]).contains(np.zeros((0, 2), dtype=np.int64)).shape == (0,)


def test_cropping_keeps_every_explored_cell_where_it_was():
    cells = np.zeros((50, 80))
    cells[20, 30], cells[25, 60] = Cell.FREE, Cell.OCCUPIED
    grid = grid_of(cells)
    cropped = grid.cropped(margin_m=0.1)
    assert cropped.cells.shape == (6 + 4, 31 + 4)
    for row, column in ((20, 30), (25, 60)):
        x, y = grid.centre_of(row, column)
        assert cropped.state_at(x, y) is grid.state_at(x, y)


def test_an_unexplored_map_can_be_cropped():
    assert grid_of(np.zeros((5, 5))).cropped().cells.size >= 1


def test_masks_partition_the_map():
    grid = grid_of([[Cell.UNKNOWN, Cell.FREE, Cell.OCCUPIED]])
    assert grid.free.sum() == grid.occupied.sum() == 1
    assert (grid.explored == (grid.free | grid.occupied)).all()
