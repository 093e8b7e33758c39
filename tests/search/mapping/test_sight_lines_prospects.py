"""What positions would show of the unknown, on maps drawn by hand."""

import numpy as np
import pytest

from drawn_grids import drawn
from hypernav.core.geometry.grid import Cell
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.grid_kernels import travel_cells, unknown_in_view
from hypernav.search.mapping.reachable_area import ReachableArea
from hypernav.search.mapping.sight_lines import find_legs_m, find_prospects

RANGE_M = 5.0
# Letters are squares of 0.5 m. Behind the wall on the right lies as much unknown as on the left.
WALLED = """
    ??????????????????
    ?###############??
    ??..............#?
    ??..............#?
    ?###############??
    ??????????????????
"""
LEFT, RIGHT = (1.25, 1.5), (7.75, 1.5)


def area(text, robot):
    grid = drawn(text, scale=10)
    return ReachableArea.of(grid, Pose2(robot[0], robot[1], 0.0), MappingConfig(), 0.2)


def prospects(text, positions, range_m=RANGE_M):
    return find_prospects(area(text, positions[0]), positions, range_m)


def view(text, row, column, reach=50):
    """The cells that are seen from one, each its own patch, numbered from the lower left."""
    grid = drawn(text)
    cells = np.pad(grid.cells, reach)
    at = np.array([[row + reach, column + reach]])
    shows, chance = unknown_in_view(cells, at, reach, 720, 1e9, 1)
    inner = (slice(reach, -reach), slice(reach, -reach))
    return shows[0][inner], chance[inner]


def test_nothing_behind_a_wall_is_seen():
    shows, _ = view(
        """
        ??#??
        ..#??
        ??#??
        """,
        1,
        0,
    )
    assert shows.tolist() == [[True, True, False, False, False]] * 1 + [
        [False] * 5,
        [True, True, False, False, False],
    ]


def test_nothing_is_seen_between_two_obstacles_that_touch_at_a_corner():
    shows, _ = view(
        """
        ???#.
        ??#..
        ?#...
        #....
        .....
        """,
        1,
        4,
    )
    assert not shows.any()


def test_only_the_unknown_counts():
    shows, chance = view(
        """
        ....?
        """,
        0,
        0,
    )
    assert shows.tolist() == [[False, False, False, False, True]]
    assert np.array_equal(chance > 0, shows)


def test_of_the_unknown_the_far_counts_less():
    cells = np.zeros((1, 400), np.uint8)
    cells = np.pad(cells, 50)
    _, chance = unknown_in_view(cells, np.array([[50, 50]]), 40, 1, 20.0, 1)
    line = chance[50, 51:91]
    assert line == pytest.approx(np.exp(-np.arange(1, 41) / 20.0), rel=1e-5)


def test_an_open_side_shows_more_than_a_wall():
    found = prospects(WALLED, [LEFT, RIGHT])
    left, right = found.gains_m2
    assert left > 1.0
    assert right < 0.1


def test_beyond_the_map_the_unknown_goes_on():
    margin = "\n".join("?" * 30 + line.strip() for line in WALLED.split())
    there = (LEFT[0] + 15.0, LEFT[1])
    assert prospects(margin, [there]).gains_m2 == pytest.approx(
        prospects(WALLED, [LEFT]).gains_m2, rel=0.02
    )


def test_what_is_shown_is_unknown_there_and_no_farther_than_the_range():
    grid = area(WALLED, LEFT).grid
    found = prospects(WALLED, [LEFT])
    cells = grid.cells_of(found.positions)
    inside = grid.contains(cells)
    assert not inside.all()
    patch = np.arange(-2, 3)  # a patch is four cells wide
    for row, column in cells[inside]:
        rows = np.clip(row + patch, 0, grid.cells.shape[0] - 1)
        columns = np.clip(column + patch, 0, grid.cells.shape[1] - 1)
        assert (grid.cells[np.ix_(rows, columns)] == Cell.UNKNOWN).any()
    assert np.linalg.norm(found.positions - LEFT, axis=1).max() < RANGE_M + 0.2


def test_what_two_positions_show_both_counts_once():
    beside = (LEFT[0] + 0.2, LEFT[1])
    found = prospects(WALLED, [LEFT, beside])
    both = found.areas_m2[found.shows.all(axis=0)].sum()
    assert both > 0.8 * found.gains_m2.min()
    assert found.areas_m2.sum() < found.gains_m2.sum()


def test_paths_between_positions_lead_around_walls():
    text = """
        .........
        .........
        .###.###.
        .#.....#.
        .#.....#.
        .###.###.
        .........
        .........
    """
    inside, below = (1.75, 1.75), (1.75, 0.25)
    outside = (0.25, 1.75)
    legs_m = find_legs_m(area(text, inside), [inside, below, outside])
    assert legs_m == pytest.approx(legs_m.T)
    assert np.all(np.diag(legs_m) == 0.0)
    assert legs_m[0, 2] > 2.0  # 1.5 m through the wall
    assert np.isfinite(legs_m).all()


def test_paths_over_patches_need_no_compilation_of_their_own(monkeypatch):
    given = []

    def noted(is_open, *rest):
        given.append(is_open)
        return travel_cells(is_open, *rest)

    monkeypatch.setattr("hypernav.search.mapping.sight_lines.travel_cells", noted)
    find_legs_m(area(WALLED, LEFT), [LEFT, RIGHT])
    assert given
    assert all(patches.flags.c_contiguous for patches in given)
