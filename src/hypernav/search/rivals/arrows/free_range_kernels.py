"""Free ranges over the floor of a depth image, compiled."""

import math

import numpy as np
from numba import njit

from hypernav.search.mapping.top_down_kernels import is_measured


@njit(cache=True, nogil=True)
def walk_lines(depth, lens, rotation, height, headings, band, farthest, limits, least):
    """How far the floor is free along some headings.

    Along each heading the line over the floor is followed in the image, pixel by pixel away from
    the robot, until at most two of four successive pixels show floor.

    Args:
        depth: float32 (rows, columns), metres.
        lens: ``(fx, fy, cx, cy)``, focal lengths and principal point, pixels.
        rotation: float64 (3, 3), camera to base.
        height: Height of the camera above the floor, metres.
        headings: float64 (n,), radians from the robot's heading, positive to the left.
        band: Least and greatest height of floor above the base, metres.
        farthest: Length of the lines on the floor, metres.
        limits: Smallest and largest measured depth, exclusive, metres.
        least: Length in the image, pixels, up to which a line counts as blocked.

    Returns:
        float64 (n,), metres; 0 where the path is blocked or out of the image.
    """
    fx, fy, cx, cy = lens
    rows, columns = depth.shape
    ranges = np.zeros(len(headings))
    for k in range(len(headings)):
        x, y = math.cos(headings[k]), math.sin(headings[k])
        # In camera coordinates a point of the line is `start + s * step`.
        step_x = rotation[0, 0] * x + rotation[1, 0] * y
        step_y = rotation[0, 1] * x + rotation[1, 1] * y
        step_z = rotation[0, 2] * x + rotation[1, 2] * y
        start_x, start_y = -rotation[2, 0] * height, -rotation[2, 1] * height
        start_z = -rotation[2, 2] * height
        if step_z <= 0.0:
            continue
        # The line enters the image through its lower edge.
        below = (rows - cy) / fy
        slope = below * step_z - step_y
        s = max((start_y - below * start_z) / slope, 0.0) if slope > 1e-9 else 0.0
        walked, window = 0, 0
        while s < farthest:
            z = start_z + s * step_z
            if z <= 1e-6:
                s += 0.05
                continue
            u = cx + fx * (start_x + s * step_x) / z
            v = cy + fy * (start_y + s * step_y) / z
            # One pixel further along the line, at least a millimetre on the floor.
            s_here = s
            speed = abs(fy * (step_y * z - (start_y + s * step_y) * step_z) / (z * z))
            across = abs(fx * (step_x * z - (start_x + s * step_x) * step_z) / (z * z))
            s += max(1.0 / max(speed, across, 1e-6), 1e-3)
            if v >= rows or v < 0.0 or u < 0.0 or u >= columns:
                if walked > 0:
                    break
                continue
            d = depth[int(v), int(u)]
            is_floor = False
            if is_measured(d, limits[0], limits[1]):
                a, b = (u - cx) / fx, (v - cy) / fy
                z_up = height + d * (rotation[2, 0] * a + rotation[2, 1] * b + rotation[2, 2])
                is_floor = band[0] <= z_up <= band[1]
            walked += 1
            window = ((window << 1) | (1 if is_floor else 0)) & 15
            if is_floor:
                ranges[k] = s_here
            if walked >= 4:
                inside = (window & 1) + (window >> 1 & 1) + (window >> 2 & 1) + (window >> 3 & 1)
                if inside <= 2:
                    break
        if walked <= least:
            ranges[k] = 0.0
    return ranges
