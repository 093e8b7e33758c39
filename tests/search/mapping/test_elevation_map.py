"""The map of heights around the robot moves with it."""

import numpy as np
import pytest

from hypernav.search.mapping.elevation_map import _shifted


@pytest.mark.parametrize("i", [-9, -3, 0, 2, 9])
@pytest.mark.parametrize("j", [-12, -4, 0, 5, 12])
def test_a_window_that_moves_keeps_what_it_still_shows(i: int, j: int):
    before = np.arange(63, dtype=np.float32).reshape(7, 9)
    moved = _shifted(before, (i, j), np.float32(-1.0))
    for row, column in np.ndindex(moved.shape):
        was = (row + i, column + j)
        is_kept = 0 <= was[0] < 7 and 0 <= was[1] < 9
        assert moved[row, column] == (before[was] if is_kept else -1.0)
