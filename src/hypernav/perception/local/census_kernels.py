"""What an image of instance numbers shows, compiled."""

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def census(ids, most):
    """Pixels and boxes of all instances, counted by runs of equal pixels.

    Args:
        ids: int32 (height, width), number of every pixel's instance; negative where there is none.
        most: Largest number in it.

    Returns:
        int64 (most + 1,), number of pixels of every instance, and int64 (most + 1, 4), its box
        ``(x_min, y_min, x_max, y_max)``, maximum exclusive.
    """
    pixels = np.zeros(most + 1, dtype=np.int64)
    boxes = np.zeros((most + 1, 4), dtype=np.int64)
    width = ids.shape[1]
    for v in range(ids.shape[0]):
        row = ids[v]
        first = 0
        for u in range(1, width + 1):
            if u < width and row[u] == row[u - 1]:
                continue
            one = row[first]
            if one >= 0:
                if pixels[one] == 0:
                    boxes[one, 0], boxes[one, 1] = first, v
                boxes[one, 0] = min(boxes[one, 0], first)
                boxes[one, 2] = max(boxes[one, 2], u)
                boxes[one, 3] = v + 1
                pixels[one] += u - first
            first = u
    return pixels, boxes
