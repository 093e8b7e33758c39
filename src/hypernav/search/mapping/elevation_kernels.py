"""Integration of one depth frame into the elevation map, compiled.

The kernel takes plain arrays and plain tuples; see `hypernav.search.mapping.top_down_kernels`.
All heights are in the ``map`` frame, metres.
"""

import math

import numpy as np
from numba import njit
from numba.extending import register_jitable

from hypernav.search.mapping.config import HIT_WEIGHT, MAX_EVIDENCE, OCCUPIED_EVIDENCE
from hypernav.search.mapping.top_down_kernels import FREE, OCCUPIED, is_measured

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
HEIGHT_ERROR_M = 0.15
"""How far ground may seem above or below its height, or that at which the robot is said to be,
metres: poses on meshes of floors were off by up to 0.13; less than a riser tells treads apart."""
_STEEPEST = 0.75
"""Slope of steep stairs, rise over run."""
BUMPED = 255
"""Evidence of what the robot bumped into: no image takes it away."""


@register_jitable(no_cfunc_wrapper=True)
def is_level(depth, u, v, across, down, start, lens, x, y, z):
    """Whether the surface at ``(x, y, z)`` is level, seen from its pixel and one above, (u, v)."""
    e = depth[v, u]
    if z >= start[2] - _BELOW_CAMERA_M or not is_measured(e, lens[0], lens[1]):
        return False
    dx = start[0] + e * (across[u, 0] + down[v, 0]) - x
    dy = start[1] + e * (across[u, 1] + down[v, 1]) - y
    run = np.sqrt(dx * dx + dy * dy)
    rise = abs(start[2] + e * (across[u, 2] + down[v, 2]) - z)
    return run < _GAP_M and rise <= _LEVEL_SLOPE * run + _LEVEL_NOISE_M


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
            ``hits`` uint8, evidence of an obstacle; ``hit_z`` and ``hit_top`` float32, heights of
            its lowest and highest point in the latest frame that showed it; ``below`` float32,
            latest height of the robot from which a ray showed no ground at that height; infinite
            without.
        scratch: ``top`` float32, minus infinity, and ``blocked`` uint8, zero, both of the map's
            shape, on entry and on return; ``touched`` int32 (cells).

    Returns:
        Number of cells with ground about a step above or below the robot's, or newly found below.
    """
    heights, hits, hit_z, hit_top, below = arrays
    top, blocked, touched = scratch
    floor_z, tall, low = here
    x0, y0, side = sizes
    rows, columns = heights.shape
    n = 0
    off_level = 0
    on_floor = np.zeros(depth.shape[1], dtype=np.bool_)
    apart = max(depth.shape[1] // _FINE, 1)
    coarse = max(depth.shape[1] // _COARSE, 1)
    levels = np.zeros((depth.shape[0], depth.shape[1] // coarse + 1), dtype=np.bool_)
    for v in range(depth.shape[0] - 1, apart - 1, -apart):
        for u in range(0, depth.shape[1], coarse):
            fall = across[u, 2] + down[v, 2]
            if fall >= 0.0:
                continue  # ground is below the camera
            d = depth[v, u]
            if not is_measured(d, lens[0], lens[1]):
                if on_floor[u] and not 0.0 < d <= lens[0]:  # nothing within range comes back
                    d = (floor_z - start[2]) / fall
                    if d < _EXPECTED * lens[1]:
                        i = math.floor((start[1] + d * (across[u, 1] + down[v, 1]) - y0) / side)
                        j = math.floor((start[0] + d * (across[u, 0] + down[v, 0]) - x0) / side)
                        if 0 <= i < rows and 0 <= j < columns:
                            off_level += below[i, j] != floor_z
                            below[i, j] = floor_z
                continue
            z = start[2] + d * fall
            if z > floor_z + tall + 1.0:
                continue
            x = start[0] + d * (across[u, 0] + down[v, 0])
            y = start[1] + d * (across[u, 1] + down[v, 1])
            row, column = math.floor((y - y0) / side), math.floor((x - x0) / side)
            if z < floor_z - _DROP_M and z < start[2]:
                share = (start[2] - floor_z) / (start[2] - z)
                i = math.floor((start[1] + share * (y - start[1]) - y0) / side)
                j = math.floor((start[0] + share * (x - start[0]) - x0) / side)
                if 0 <= i < rows and 0 <= j < columns:
                    off_level += below[i, j] != floor_z
                    below[i, j] = floor_z
            if not (0 <= row < rows and 0 <= column < columns):
                continue
            level = is_level(depth, u, v - apart, across, down, start, lens, x, y, z)
            is_edge = on_floor[u] and not is_measured(depth[v - apart, u], lens[0], lens[1])
            on_floor[u] = (level or is_edge) and z - floor_z < low / 2.0
            if level:
                levels[v, u // coarse] = True
                if top[row, column] == -np.inf:
                    touched[n] = row * columns + column
                    n += 1
                top[row, column] = max(top[row, column], z)
    for k in range(n):
        row, column = touched[k] // columns, touched[k] % columns
        if np.isnan(heights[row, column]):
            hits[row, column] = 0
        heights[row, column] = top[row, column]
        if low / 2.0 < abs(top[row, column] - floor_z) < 2.0 * low:
            off_level += 1
    for v in range(depth.shape[0] - 1, apart - 1, -coarse):
        for u in range(0, depth.shape[1], coarse):
            d = depth[v, u]
            if levels[v, u // coarse] or not is_measured(d, lens[0], lens[1]):
                continue
            z = start[2] + d * (across[u, 2] + down[v, 2])
            if z > floor_z + tall + 1.0:
                continue
            x = start[0] + d * (across[u, 0] + down[v, 0])
            y = start[1] + d * (across[u, 1] + down[v, 1])
            row, column = math.floor((y - y0) / side), math.floor((x - x0) / side)
            if not (0 <= row < rows and 0 <= column < columns):
                continue
            ground = heights[row, column]
            if np.isnan(ground):
                ground = floor_z
            if not (ground + low < z < ground + tall and blocked[row, column] < 255):
                continue
            if is_level(depth, u, v - apart, across, down, start, lens, x, y, z):
                continue
            if blocked[row, column] == 0 and top[row, column] == -np.inf:
                touched[n] = row * columns + column
                n += 1
            if blocked[row, column] == 0 or z < hit_z[row, column]:
                hit_z[row, column] = z
            if blocked[row, column] == 0 or z > hit_top[row, column]:
                hit_top[row, column] = z
            blocked[row, column] += 1
    for k in range(n):
        row, column = touched[k] // columns, touched[k] % columns
        if blocked[row, column] > 1:
            now = min(hits[row, column] + HIT_WEIGHT, MAX_EVIDENCE)
            hits[row, column] = max(now, hits[row, column])
        elif 0 < hits[row, column] < BUMPED:
            hits[row, column] -= 1
        top[row, column] = -np.inf
        blocked[row, column] = 0
    return off_level


@njit(cache=True, nogil=True)
def sort_ground(maps, masks, to_robot, robot_z, limits, down):
    """Tell which cells around the robot are ground, and how high.

    Args:
        maps: A part of the five maps of `survey`.
        masks: Where heights belong to the robot's storey, the same with gaps of one cell closed,
            and with wider ones closed.
        to_robot: Corner ``(x, y)`` of the part, from the robot, and side of a cell, metres.
        robot_z: float32, height of the robot, metres.
        limits: Distance within which the camera sees no ground, highest step, and height of the
            robot, metres.
        down: Whether unseen steps down are presumed where only the depth below was seen.

    Returns:
        float32 heights of the ground, NaN where it is not seen; masks of the unseen ground around
        the robot or in the midst of what is seen, of presumed steps down, and of the cells on which
        nothing stands.
    """
    known, hits, hit_z, hit_top, below = maps
    measured, seen, spots = masks
    blind_m, step_m, tall_m = limits
    heights = np.full(known.shape, np.float32(np.nan))
    blind = np.zeros(known.shape, dtype=np.bool_)
    presumed = np.zeros(known.shape, dtype=np.bool_)
    clear = np.zeros(known.shape, dtype=np.bool_)
    for i in range(known.shape[0]):
        for j in range(known.shape[1]):
            if measured[i, j]:
                heights[i, j] = known[i, j]
            elif seen[i, j]:
                heights[i, j] = highest_around(known, measured, i, j)
            clear[i, j] = hits[i, j] < BUMPED
            if hits[i, j] >= OCCUPIED_EVIDENCE:
                # Stairs may lie one above another: only what stands on the ground is an obstacle.
                above_m = hit_z[i, j] - (heights[i, j] if seen[i, j] else robot_z)
                stands = above_m > (step_m / 2.0 if seen[i, j] else -step_m) and above_m < tall_m
                if not (seen[i, j] or down):  # on the way up it may be the next riser
                    rise_m = hit_top[i, j] - highest_around(known, measured, i, j)
                    stands = stands and rise_m > step_m
                clear[i, j] &= not stands
            if seen[i, j]:
                continue
            dropped_m = below[i, j] - robot_z
            if not spots[i, j] and abs(dropped_m) <= np.float32(HEIGHT_ERROR_M):
                presumed[i, j] = down and clear[i, j]
                continue
            x = (j + 0.5) * to_robot[2] + to_robot[0]
            y = (i + 0.5) * to_robot[2] + to_robot[1]
            if spots[i, j] or x * x + y * y <= blind_m * blind_m:
                blind[i, j] = True
            elif 0.0 < dropped_m < np.float32(blind_m * _STEEPEST):
                # Right before the robot the camera sees no stairs; they go on as they began.
                presumed[i, j] = down and clear[i, j]
    return heights, blind, presumed, clear


@register_jitable(no_cfunc_wrapper=True)
def highest_around(heights, mask, row, column):
    """The greatest height of a mask's cells around a cell."""
    highest = np.float32(-np.inf)
    for i in range(max(row - 1, 0), min(row + 2, heights.shape[0])):
        for j in range(max(column - 1, 0), min(column + 2, heights.shape[1])):
            if mask[i, j]:
                highest = max(highest, heights[i, j])
    return highest


@njit(cache=True, nogil=True)
def open_ground(heights, known, clear, presumed, to_robot, under_m, step_m):
    """The ground that can be walked on, as free and occupied cells.

    Args:
        heights: float32, heights of the ground, metres; NaN where none was seen.
        known: Mask of the cells that count as ground.
        clear: Mask of those on which nothing stands.
        presumed: Mask of presumed steps down, which are open.
        to_robot: As for `sort_ground`.
        under_m: Distance from the robot within which heights count for nothing: the height at which
            it stands is between those of the treads under it.
        step_m: Greatest difference of the heights around a cell, metres.
    """
    rows, columns = heights.shape
    lows = np.full((rows + 2, columns + 2), np.float32(np.inf))
    highs = np.full((rows + 2, columns + 2), np.float32(-np.inf))
    for i in range(rows):
        for j in range(columns):
            x, y = (j + 0.5) * to_robot[2] + to_robot[0], (i + 0.5) * to_robot[2] + to_robot[1]
            if not np.isnan(heights[i, j]) and x * x + y * y > under_m * under_m:
                lows[i + 1, j + 1] = highs[i + 1, j + 1] = heights[i, j]
    for i in range(rows + 2):  # of three cells in a row, then of three in a column
        for j in range(columns):
            lows[i, j] = min(lows[i, j], lows[i, j + 1], lows[i, j + 2])
            highs[i, j] = max(highs[i, j], highs[i, j + 1], highs[i, j + 2])
    cells = np.full(heights.shape, np.uint8(OCCUPIED))
    for i in range(rows):
        for j in range(columns):
            low = min(lows[i, j], lows[i + 1, j], lows[i + 2, j])
            high = max(highs[i, j], highs[i + 1, j], highs[i + 2, j])
            is_even = high - low <= np.float32(step_m)
            if presumed[i, j] or (known[i, j] and clear[i, j] and is_even):
                cells[i, j] = FREE
    return cells
