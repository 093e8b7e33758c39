"""Filters solid spans that a robot can't stand on (numba kernels), as ``RecastFilter.cpp``.

Spans are rows of lowest voxel, voxel above, and 1 where a robot can stand; column after column.
"""

import numpy as np
from numba import njit

_LOW, _HIGH, _WALKABLE = 0, 1, 2
_OPEN = 0xFFFF
"""Ceiling of a column's highest span, which has none."""
_DIRECTIONS = np.array([[-1, 0], [0, 1], [1, 0], [0, -1]], dtype=np.int32)


@njit(cache=True, nogil=True)
def keep_low_obstacles(start, spans, climb):
    """Make low obstacles on walkable spans walkable if the robot can climb them."""
    for column in range(len(start) - 1):
        was_walkable = False
        for i in range(start[column], start[column + 1]):
            walkable = spans[i, _WALKABLE] == 1
            if not walkable and was_walkable and spans[i, _HIGH] - spans[i - 1, _HIGH] <= climb:
                spans[i, _WALKABLE] = 1
            # One obstacle on another doesn't count.
            was_walkable = walkable


@njit(cache=True, nogil=True)
def drop_ledges(start, spans, width, height, climb):
    """Make spans not walkable beside a drop, or on a slope, that the robot can't climb."""
    depth = (len(start) - 1) // width
    for z in range(depth):
        for x in range(width):
            column = x + z * width
            for i in range(start[column], start[column + 1]):
                if spans[i, _WALKABLE] == 1 and _is_ledge(
                    start, spans, i, x, z, width, depth, height, climb
                ):
                    spans[i, _WALKABLE] = 0


@njit(cache=True, nogil=True)
def drop_low_ceilings(start, spans, height):
    """Make spans not walkable if the robot is too high for the space above them."""
    for column in range(len(start) - 1):
        for i in range(start[column], start[column + 1]):
            if _ceiling(spans, i, start[column + 1]) - spans[i, _HIGH] < height:
                spans[i, _WALKABLE] = 0


@njit(cache=True, nogil=True)
def _ceiling(spans, i, end):
    return spans[i + 1, _LOW] if i + 1 < end else _OPEN


@njit(cache=True, nogil=True)
def _is_ledge(start, spans, i, x, z, width, depth, height, climb):
    own = x + z * width
    floor, ceiling = spans[i, _HIGH], _ceiling(spans, i, start[own + 1])
    drop = _OPEN
    lowest, highest = floor, floor
    for direction in range(4):
        nx, nz = x + _DIRECTIONS[direction, 0], z + _DIRECTIONS[direction, 1]
        if nx < 0 or nz < 0 or nx >= width or nz >= depth:
            drop = min(drop, -climb - floor)
            continue
        column = nx + nz * width
        begin, end = start[column], start[column + 1]
        # from minus infinity to the first span
        gap_top = spans[begin, _LOW] if begin < end else _OPEN
        if min(ceiling, gap_top) - max(floor, -climb) > height:
            drop = min(drop, -climb - floor)
        for k in range(begin, end):
            beside = spans[k, _HIGH]
            if min(ceiling, _ceiling(spans, k, end)) - max(floor, beside) > height:
                drop = min(drop, beside - floor)
                if abs(beside - floor) <= climb:
                    lowest, highest = min(lowest, beside), max(highest, beside)
    return drop < -climb or highest - lowest > climb
