"""Distances from the cells of a mask."""

import cv2
import numpy as np
from jaxtyping import Bool, Float32


def distance_from(
    mask: Bool[np.ndarray, "rows columns"],
) -> Float32[np.ndarray, "rows columns"]:
    """Distance of every cell from the nearest cell of a mask, between middles, cells.

    Where the mask has no cell it is infinite. The same mask gives the same bytes, at distances up
    to 4,000 cells: OpenCV's own result errs by up to 4e-6 cells, with Intel's library differently
    at every address in memory, so that of two equally near cells either might be the nearer one.
    """
    if not mask.any():
        return np.full(mask.shape, np.inf, np.float32)
    nearly = cv2.distanceTransform((~mask).view(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    # The square of a distance between cells is a whole number.
    return np.sqrt(np.rint(np.square(nearly, dtype=np.float64))).astype(np.float32)
