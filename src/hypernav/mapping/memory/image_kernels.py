"""Points that pixels of an image show, and objects that it should show, compiled.

Poses are the upper three rows of a matrix, flat, and ``lens`` is fx, fy, cx, cy, pixels.
"""

import numpy as np
from numba import njit

from hypernav.mapping.top_down.depth_kernels import is_measured


@njit(cache=True, nogil=True)
def points_under(mask, depth, window, stride, limits, lens, pose):
    """The masked pixels of a part of the image that have a depth, as points.

    Args:
        mask: bool (height, width).
        depth: float32 (height, width), metres.
        window: First column and row, and the ones after the last.
        stride: Step between the pixels in use, in both directions.
        limits: Limits of the sensor's range, both exclusive, metres.
        lens: Intrinsics of the camera.
        pose: Pose of the camera, optical to ``map`` frame.

    Returns:
        float64 (n, 3), points ``(x, y, z)``, ``map`` frame, metres, row by row.
    """
    left, top, right, bottom = window
    rows, columns = (bottom - top + stride - 1) // stride, (right - left + stride - 1) // stride
    points = np.empty((max(rows * columns, 0), 3))
    n = 0
    for v in range(top, bottom, stride):
        for u in range(left, right, stride):
            if not mask[v, u] or not is_measured(depth[v, u], limits[0], limits[1]):
                continue
            z = np.float64(depth[v, u])
            x, y = (u + 0.5 - lens[2]) / lens[0] * z, (v + 0.5 - lens[3]) / lens[1] * z
            for i in range(3):
                points[n, i] = (
                    pose[4 * i] * x + pose[4 * i + 1] * y + pose[4 * i + 2] * z + pose[4 * i + 3]
                )
            n += 1
    return points[:n]


@njit(cache=True, nogil=True)
def count_visible(positions, heights, depth, farthest, lens, pose, limits, slack):
    """Count the positions of objects that are in the image, and those that nothing hides.

    Args:
        positions: float64 (objects, n, 2), ``(x, y)``, ``map`` frame, metres.
        heights: float64 (objects,), their heights above the floor, metres.
        depth: float32 (height, width), metres.
        farthest: float32 (width,), largest depth of every column, metres.
        lens: Intrinsics of the camera.
        pose: The inverse of the camera's pose, ``map`` to optical frame.
        limits: Depths between which positions count, both exclusive, metres.
        slack: Depths, metres, by which the farthest of the column and that of the pixel may be less
            than that of a position which is not hidden.

    Returns:
        int64 (objects, 2), the number of positions in the image, and of those that are not hidden.
    """
    height, width = depth.shape
    counts = np.zeros((len(positions), 2), dtype=np.int64)
    for i in range(len(positions)):
        for j in range(positions.shape[1]):
            x, y, h = positions[i, j, 0], positions[i, j, 1], heights[i]
            z = pose[8] * x + pose[9] * y + pose[10] * h + pose[11]
            if not limits[0] < z < limits[1]:
                continue
            u = lens[0] * (pose[0] * x + pose[1] * y + pose[2] * h + pose[3]) / z + lens[2]
            v = lens[1] * (pose[4] * x + pose[5] * y + pose[6] * h + pose[7]) / z + lens[3]
            if not (0.0 <= u < width and 0.0 <= v < height):
                continue
            row, column = int(v), int(u)
            counts[i, 0] += 1
            is_open = farthest[column] > z - slack[0] and depth[row, column] > z - slack[1]
            counts[i, 1] += is_open
    return counts
