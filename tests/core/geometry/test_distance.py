import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from hypernav.core.geometry.distance import distance_from


@given(arrays.arrays(bool, st.tuples(st.integers(1, 12), st.integers(1, 12))))
def test_it_is_that_of_the_nearest_cell_to_the_last_bit(mask):
    there = np.argwhere(mask)
    for cell, distance in np.ndenumerate(distance_from(mask)):
        away = ((there - cell) ** 2).sum(axis=1)
        assert distance == (np.float32(np.sqrt(away.min())) if len(there) else np.inf)


@pytest.mark.parametrize("shape", [(41, 39), (57, 90), (100, 117)])
def test_where_the_mask_lies_in_memory_changes_nothing(shape):
    rng = np.random.default_rng(0)
    mask = rng.random(shape) < 0.01
    results = set[bytes]()
    for offset in range(64):
        room = np.empty(mask.size + 64, dtype=bool)
        moved = room[offset : offset + mask.size].reshape(shape)
        moved[:] = mask
        results.add(distance_from(moved).tobytes())
    assert len(results) == 1
