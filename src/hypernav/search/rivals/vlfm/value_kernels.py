"""Cone-weighted fusion of values into a grid, compiled."""

import math

import numpy as np
from numba import njit

from hypernav.search.mapping.top_down_kernels import is_measured


@njit(cache=True, nogil=True)
def reach_of_columns(depth, forward, nearest, farthest):
    """Distance that each image column sees, along the camera's heading on the floor plan.

    Args:
        depth: float32 (height, width), metres.
        forward: float32 (height,), metres ahead on the floor plan per metre of depth, by row.
        nearest: Lower limit of measured depth, exclusive, metres.
        farthest: Upper limit of measured depth, exclusive, metres.

    Returns:
        float32 (width,), metres; 0 where nothing was measured.
    """
    height, width = depth.shape
    reach = np.zeros(width, dtype=np.float32)
    for row in range(height):
        per_metre = forward[row]
        for column in range(width):
            d = depth[row, column]
            ahead = d * per_metre if is_measured(d, nearest, farthest) else np.float32(0.0)
            reach[column] = max(reach[column], ahead)
    return reach


@njit(cache=True, nogil=True)
def fuse_view(values, confidences, corner, size, eye, lens, reach, weights, value, threshold):
    """Fuse one value into all cells that a view shows.

    Args:
        values: float32 (rows, columns), changed in place.
        confidences: float32 (rows, columns), changed in place; 0 where nothing was fused yet.
        corner: Lower left corner ``(x, y)`` of the cells, metres.
        size: Side of a cell, metres.
        eye: Position ``(x, y)`` of the camera, metres, and cosine and sine of its heading.
        lens: Focal length and column of the principal point, pixels.
        reach: float32 (width,), metres; see `reach_of_columns`.
        weights: float32 (width,), confidence of a view in each image column, 0 to 1.
        value: Value of the view.
        threshold: Confidence below which a view counts only where the cell's confidence so far is
            not higher.
    """
    x_eye, y_eye, cosine, sine = eye
    focal, centre = lens
    width = len(reach)
    for i in range(values.shape[0]):
        dy = corner[1] + (i + 0.5) * size - y_eye
        for j in range(values.shape[1]):
            dx = corner[0] + (j + 0.5) * size - x_eye
            ahead = dx * cosine + dy * sine
            if ahead <= 0.0:
                continue
            u = centre + focal * (dx * sine - dy * cosine) / ahead
            if not 0.0 <= u < width or ahead > reach[int(u)]:
                continue
            new, old = weights[int(u)], confidences[i, j]
            if new < threshold and new < old:
                continue
            total = old + new
            values[i, j] += (value - values[i, j]) * (new / total)
            confidences[i, j] = (old * old + new * new) / total


@njit(cache=True, nogil=True)
def medians_around(values, confidences, centres, radius):
    """Median of the values around some cells.

    Args:
        values: float32 (rows, columns).
        confidences: float32 (rows, columns), 0 where there is no value.
        centres: float64 (n, 2), continuous ``[row, column]``.
        radius: Radius, cells.

    Returns:
        float64 (n,), the medians; -1 where no value is near.
    """
    rows, columns = values.shape
    medians = np.full(len(centres), -1.0)
    near = np.empty(int(2.0 * radius + 3.0) ** 2, dtype=np.float32)
    for k in range(len(centres)):
        row, column = centres[k]
        n = 0
        for i in range(max(math.floor(row - radius), 0), min(math.ceil(row + radius), rows)):
            for j in range(
                max(math.floor(column - radius), 0), min(math.ceil(column + radius), columns)
            ):
                away = (i + 0.5 - row) ** 2 + (j + 0.5 - column) ** 2
                if away <= radius * radius and confidences[i, j] > 0.0:
                    near[n] = values[i, j]
                    n += 1
        if n > 0:
            medians[k] = np.median(near[:n])
    return medians
