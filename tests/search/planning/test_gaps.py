"""Gaps that are closed by little."""

import numpy as np
import pytest

from certainty import certain
from hypernav.core.embodiment import Embodiment
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.planning.config import PlanningConfig
from hypernav.search.planning.navigator import Navigator

ROBOT, BEYOND = Pose2(1.2, 1.0, 0.0), np.array([[1.2, 3.0]])


def wall_with(gap_cells):
    """A wall across a room of 4 m x 4 m, with a gap around x 1.2."""
    cells = np.full((80, 80), Cell.FREE, dtype=np.uint8)
    cells[38:42] = Cell.OCCUPIED
    cells[38:42, 24 - gap_cells // 2 : 24 - gap_cells // 2 + gap_cells] = Cell.FREE
    return OccupancyGrid(cells, 0.05, (0.0, 0.0))


def gap_of(gap_cells, closed=(), **planning):
    navigator = Navigator(PlanningConfig(**planning), Embodiment())
    return navigator.gap_towards(wall_with(gap_cells), ROBOT, BEYOND, closed)


@pytest.mark.parametrize(
    ("gap_cells", "is_doubtful"), [(2, False), (4, False), (6, True), (10, False)]
)
def test_only_a_gap_that_fails_by_little_is_in_doubt(gap_cells, is_doubtful):
    assert (gap_of(gap_cells) is not None) == is_doubtful


@pytest.mark.parametrize(("gap_cells", "is_doubtful"), [(6, False), (8, True), (10, False)])
def test_a_robot_that_never_squeezes_doubts_wider_gaps(gap_cells, is_doubtful):
    assert (gap_of(gap_cells, squeeze_m=0.0) is not None) == is_doubtful


def test_it_is_looked_at_from_before_it_once():
    gap = certain(gap_of(6))
    assert gap.look_from[1] < gap.position[1] <= 2.1
    assert gap_of(6, closed=(gap.position,)) is None
    assert gap_of(6, closed=((3.5, 1.9),)) == gap
