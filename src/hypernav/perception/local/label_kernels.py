"""Counts of labelled pixels, compiled."""

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def pixels_of_each(ids, count):
    """Number of pixels of every instance.

    Args:
        ids: int32 (height, width), instance of every pixel, -1 where there is none.
        count: Number of instances; ids are smaller.

    Returns:
        int64 (count,).
    """
    pixels = np.zeros(count + 1, dtype=np.int64)
    # Instances fill stretches of a row, which are counted at once.
    for row in range(ids.shape[0]):
        last, length = ids[row, 0], 0
        for column in range(ids.shape[1]):
            if ids[row, column] != last:
                pixels[last + 1] += length
                last, length = ids[row, column], 0
            length += 1
        pixels[last + 1] += length
    return pixels[1:]
