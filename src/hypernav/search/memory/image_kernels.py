"""What pixels of an image show, and which objects it should show, compiled.

Poses are the upper three rows of a matrix, flat, and ``lens`` is fx, fy, cx, cy, pixels.
"""

import math

import numpy as np
from numba import njit

from hypernav.search.mapping.top_down_kernels import is_measured


@njit(cache=True, nogil=True)
def points_under(mask, depth, window, stride, limits, lens, pose):
    """The masked pixels of a part of the image that have a depth, as points.

    Args:
        mask: bool (height, width); None for all pixels.
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
            if mask is not None:  # noqa: SIM102 - left out of the compiled loop where it is None
                if not mask[v, u]:
                    continue
            if not is_measured(depth[v, u], limits[0], limits[1]):
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
def fan_of_view(farthest, every, lens, pose, corner, side):
    """The camera and how far the columns of an image reach, as cells ``(column, row)`` of a map.

    Args:
        farthest: float32 (width,), largest depth of every column, metres.
        every: Step between the columns in use.
        lens: Intrinsics of the camera.
        pose: Pose of the camera, optical to ``map`` frame.
        corner: Lower left corner ``(x, y)`` of the map, metres.
        side: Side of a cell, metres.

    Returns:
        int32 (n, 2), the camera first.
    """
    fan = np.empty((1 + (len(farthest) + every - 1) // every, 2), dtype=np.int32)
    for k in range(len(fan)):
        z, aside = 0.0, 0.0
        if k > 0:
            u = (k - 1) * every
            z = np.float64(farthest[u]) if 0.0 < farthest[u] < np.inf else 0.0
            aside = z * (u + 0.5 - lens[2]) / lens[0]
        for i in range(2):
            along = aside * pose[4 * i] + z * pose[4 * i + 2]
            fan[k, i] = math.floor((along + (pose[4 * i + 3] - corner[i])) / side)
    return fan


@njit(cache=True, nogil=True)
def are_near(boxes, robot, fx, most_m, least_px):
    """Whether things are ahead, near and large enough to be detected where nothing hides them.

    Args:
        boxes: float64 (things, 6), lowest and highest corner of each, ``map`` frame, metres.
        robot: The robot, ``(x, y)``, metres, and its heading, radians.
        fx: Horizontal focal length, pixels.
        most_m: Greatest distance, metres.
        least_px: Least size in the image, pixels.
    """
    found = np.zeros(len(boxes), dtype=np.bool_)
    cos, sin = math.cos(robot[2]), math.sin(robot[2])
    for k in range(len(boxes)):
        x0, y0, z0, x1, y1, z1 = boxes[k]
        x, y = (x0 + x1) / 2.0 - robot[0], (y0 + y1) / 2.0 - robot[1]
        distance_m = math.hypot(x, y)
        across_m = min(max(x1 - x0, y1 - y0), z1 - z0)
        is_large = across_m * fx >= least_px * distance_m
        found[k] = is_large and distance_m <= most_m and x * cos + y * sin >= 0.0
    return found


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
