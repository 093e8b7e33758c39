"""Growth of obstacles by a radius, and distances to cells."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from scipy.ndimage import distance_transform_edt

from hypernav.search.mapping.inflation import disc, distance_from, inflate


@given(arrays.arrays(bool, st.tuples(st.integers(1, 12), st.integers(1, 12))))
def test_it_is_that_of_the_nearest_cell_to_the_last_bit(mask):
    there = np.argwhere(mask)
    for cell, distance in np.ndenumerate(distance_from(mask)):
        away = ((there - cell) ** 2).sum(axis=1)
        assert distance == (np.float32(np.sqrt(away.min())) if len(there) else np.inf)


@pytest.mark.parametrize("shape", [(41, 39), (57, 90), (100, 117)])
def test_in_maps_too(shape):
    """OpenCV's own result is off by an ulp in hundreds of these cells."""
    mask = np.random.default_rng(0).random(shape) < 0.01
    exact = np.asarray(distance_transform_edt(~mask), dtype=np.float32)
    np.testing.assert_array_equal(distance_from(mask), exact)


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
