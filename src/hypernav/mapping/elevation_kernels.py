"""Integration of one depth frame into the elevation map, compiled.

The kernel takes plain arrays and plain tuples; see `hypernav.mapping.integrate_kernels`. All
heights are in the ``map`` frame, metres.
"""

import numpy as np
from numba import njit

from hypernav.mapping.integrate_kernels import is_measured

_FINE, _COARSE = 320, 160
"""Columns of pixels that are used of an image, for ground down a column; else. The two pixels of a
column that tell whether a surface is level are as far apart as those in use."""
_LEVEL_SLOPE = 0.3
"""Steepest slope of ground, rise over run; a ramp of 15 degrees has 0.27."""
_LEVEL_NOISE_M = 0.005
_GAP_M = 0.4
"""Run, metres, beyond which two pixels of a column show two surfaces."""
_BELOW_CAMERA_M = 0.05
"""Least distance of a level surface below the camera, metres: above it are undersides."""
_DROP_M = 0.25
"""Depth below the robot's floor, metres, from which a point shows that there is no floor."""
_EXPECTED = 0.7
"""Share of the camera's range within which a level floor returns depth: where it ends and none
comes back, there is no floor."""
_FREE_HITS = 2
_MOST_HITS = 6
BUMPED = 255
"""Evidence of what the robot bumped into: no image takes it away."""


@njit(cache=True, nogil=True)
def survey(depth, across, down, start, lens, here, sizes, arrays, scratch):
    """Note the ground, obstacles on it, and where there is none, as far as a frame shows them.

    Args:
        depth: float32 (height, width), metres.
        across: float32 (width, 3), change per metre of depth for the pixel's column, metres.
        down: float32 (height, 3), change per metre of depth for the pixel's row, metres.
        start: Position of the camera, ``(x, y, z)``.
        lens: Limits of the sensor's range, both exclusive, metres.
        here: Height of the ground that the robot stands on, and of the robot, metres; then the
            height up to which things on the ground do not hinder it.
        sizes: Corner ``(x, y)`` of the map and side of a cell, metres.
        arrays: The map, rows along y: ``heights`` float32, NaN where no ground was seen;
            ``hits`` uint8, evidence of an obstacle; ``hit_z`` float32, height of
            its lowest point in the latest frame that showed it; ``below`` float32, latest
            height of the robot from which a ray showed no ground at that height; infinite without.
        scratch: ``top`` float32, minus infinity, and ``blocked`` uint8, zero, both of the map's
            shape, on entry and on return; ``touched`` int32 (cells).

    Returns:
        Number of cells with ground about a step above or below the robot's, or newly found below.
    """
    heights, hits, hit_z, below = arrays
    top, blocked, touched = scratch
    floor_z, tall, low = here
    x0, y0, side = sizes
    rows, columns = heights.shape
    n = 0
    off_level = 0
    on_floor = np.zeros(depth.shape[1], dtype=np.bool_)
    apart = max(depth.shape[1] // _FINE, 1)
    coarse = max(depth.shape[1] // _COARSE, 1)
    for pass_ in range(2):
        for v in range(depth.shape[0] - 1, apart - 1, -(coarse if pass_ else apart)):
            for u in range(0, depth.shape[1], coarse):
                if pass_ == 0 and across[u, 2] + down[v, 2] >= 0.0:
                    continue  # ground is below the camera
                d = depth[v, u]
                if not is_measured(d, lens[0], lens[1]):
                    if pass_ == 0 and on_floor[u] and d == 0.0:
                        fall = across[u, 2] + down[v, 2]
                        d = (floor_z - start[2]) / fall if fall < 0.0 else np.inf
                        if d < _EXPECTED * lens[1]:
                            i = int((start[1] + d * (across[u, 1] + down[v, 1]) - y0) / side)
                            j = int((start[0] + d * (across[u, 0] + down[v, 0]) - x0) / side)
                            if 0 <= i < rows and 0 <= j < columns:
                                off_level += below[i, j] != floor_z
                                below[i, j] = floor_z
                    continue
                z = start[2] + d * (across[u, 2] + down[v, 2])
                if z > floor_z + tall + 1.0:
                    continue
                x = start[0] + d * (across[u, 0] + down[v, 0])
                y = start[1] + d * (across[u, 1] + down[v, 1])
                row, column = int((y - y0) / side), int((x - x0) / side)
                inside = 0 <= row < rows and 0 <= column < columns and x >= x0 and y >= y0
                if pass_ == 0 and z < floor_z - _DROP_M and z < start[2]:
                    share = (start[2] - floor_z) / (start[2] - z)
                    i = int((start[1] + share * (y - start[1]) - y0) / side)
                    j = int((start[0] + share * (x - start[0]) - x0) / side)
                    if 0 <= i < rows and 0 <= j < columns:
                        off_level += below[i, j] != floor_z
                        below[i, j] = floor_z
                if not inside:
                    continue
                e = depth[v - apart, u]
                level = False
                if z < start[2] - _BELOW_CAMERA_M and is_measured(e, lens[0], lens[1]):
                    run = np.hypot(
                        start[0] + e * (across[u, 0] + down[v - apart, 0]) - x,
                        start[1] + e * (across[u, 1] + down[v - apart, 1]) - y,
                    )
                    rise = abs(start[2] + e * (across[u, 2] + down[v - apart, 2]) - z)
                    level = run < _GAP_M and rise <= _LEVEL_SLOPE * run + _LEVEL_NOISE_M
                if pass_ == 0:
                    is_edge = on_floor[u] and not is_measured(e, lens[0], lens[1])
                    on_floor[u] = (level or is_edge) and z - floor_z < low / 2.0
                    if level:
                        if top[row, column] == -np.inf:
                            touched[n] = row * columns + column
                            n += 1
                        top[row, column] = max(top[row, column], z)
                elif not level:
                    ground = heights[row, column]
                    if np.isnan(ground):
                        ground = floor_z
                    if ground + low < z < ground + tall and blocked[row, column] < 255:
                        if blocked[row, column] == 0 and top[row, column] == -np.inf:
                            touched[n] = row * columns + column
                            n += 1
                        if blocked[row, column] == 0 or z < hit_z[row, column]:
                            hit_z[row, column] = z
                        blocked[row, column] += 1
        if pass_ == 0:
            for k in range(n):
                row, column = touched[k] // columns, touched[k] % columns
                if np.isnan(heights[row, column]):
                    hits[row, column] = 0
                heights[row, column] = top[row, column]
                if low / 2.0 < abs(top[row, column] - floor_z) < 2.0 * low:
                    off_level += 1
    for k in range(n):
        row, column = touched[k] // columns, touched[k] % columns
        if blocked[row, column] >= _FREE_HITS:
            hits[row, column] = max(min(hits[row, column] + 2, _MOST_HITS), hits[row, column])
        elif 0 < hits[row, column] < BUMPED:
            hits[row, column] -= 1
        top[row, column] = -np.inf
        blocked[row, column] = 0
    return off_level
