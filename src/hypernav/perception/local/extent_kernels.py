"""Extents of the objects in an image of labels, compiled: SciPy's take longer to import."""

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def extents(ids, count):
    """Number of pixels of every object, and the smallest box around them.

    Args:
        ids: int32 (rows, columns), numbers of the objects; negative where there is none.
        count: Number of objects; all numbers are below it.

    Returns:
        int64 (count, 5): pixels; first row and column; row and column after the last.
    """
    rows, columns = ids.shape
    found = np.zeros((count, 5), dtype=np.int64)
    found[:, 1], found[:, 2] = rows, columns
    for row in range(rows):
        for column in range(columns):
            number = ids[row, column]
            if number >= 0:
                one = found[number]
                one[0] += 1
                one[1] = min(one[1], row)
                one[2] = min(one[2], column)
                one[3] = row + 1
                one[4] = max(one[4], column + 1)
    return found
