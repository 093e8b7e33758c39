"""Growth of obstacles by a radius."""

import math

import numpy as np
import pytest

from hypernav.mapping.inflation import disc, inflate


@pytest.mark.parametrize("radius_m", [0.0, 0.05, 0.12, 0.2, 0.33])
def test_a_disc_holds_the_cells_whose_middles_lie_within_the_radius(radius_m: float):
    cells = np.zeros((21, 21), dtype=bool)
    cells[10, 10] = True
    grown = inflate(cells, radius_m, 0.05)
    near = [
        [math.hypot(i - 10, j - 10) * 0.05 <= radius_m + 1e-9 for j in range(21)] for i in range(21)
    ]
    assert np.array_equal(grown > 0, near)
    assert disc(radius_m, 0.05).sum() == np.sum(near)
    assert disc(radius_m, 0.05).shape[0] % 2 == 1


def test_what_lies_outside_counts_if_told():
    grown = inflate(np.zeros((9, 9), dtype=bool), 0.1, 0.05, outside=True)
    assert (grown == 0).sum() == 25
    assert not inflate(np.zeros((9, 9), dtype=bool), 0.1, 0.05).any()
