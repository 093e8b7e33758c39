"""The nearest open cell, beside a look at all cells."""

import numpy as np
import pytest

from hypernav.search.mapping.grid_kernels import nearest_open_cell


@pytest.mark.parametrize("within", [0, 1, 3, 30])
def test_the_nearest_open_cell_is_the_lowest_leftmost_of_the_nearest(within: int):
    random = np.random.default_rng(within)
    for share in (0.0, 0.05, 0.4):
        is_open = (random.uniform(size=(9, 14)) < share).astype(np.uint8)
        for row, column in np.ndindex(13, 18):
            row, column = row - 2, column - 2
            near = [
                ((r - row) ** 2 + (c - column) ** 2, r, c)
                for r, c in np.argwhere(is_open).tolist()
                if max(abs(r - row), abs(c - column)) <= within
            ]
            expected = min(near)[1:] if near else (-1, -1)
            assert nearest_open_cell(is_open, row, column, within) == expected
