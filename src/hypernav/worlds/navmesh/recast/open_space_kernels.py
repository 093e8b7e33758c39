"""The open space above walkable spans, linked from column to column (numba kernels).

As ``rcBuildCompactHeightfield``, ``RecastArea.cpp`` and the distance field of ``RecastRegion.cpp``.
Directions are 0: -x, 1: +z, 2: +x, 3: -z.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Int32
from numba import njit

NOTHING = -1
"""Marks a missing neighbour."""

_LOW, _HIGH, _WALKABLE = 0, 1, 2
_OPEN = 0xFFFF
_MOST_ROOM = 0xFF
_MOST_LAYERS = 63
"""Largest number of spans of a column that can be linked."""
_FAR = 0xFFFF
_STRAIGHT, _DIAGONAL = 2, 3
_DIRECTIONS = np.array([[-1, 0], [0, 1], [1, 0], [0, -1]], dtype=np.int32)


class OpenSpace(NamedTuple):
    """Spans of open space, column after column, each from bottom to top.

    Attributes:
        width: Columns along x.
        depth: Columns along z.
        start: First span of every column, and the number of spans.
        x: Column of every span along x.
        z: Column of every span along z.
        floor: Height of every span's floor, voxels.
        neighbours: Span in each of the four directions that the robot can walk to, or `NOTHING`.
        walkable: Whether the middle of the robot may be on a span.
    """

    width: int
    depth: int
    start: Int32[np.ndarray, "starts"]
    x: Int32[np.ndarray, " s"]
    z: Int32[np.ndarray, " s"]
    floor: Int32[np.ndarray, " s"]
    neighbours: Int32[np.ndarray, "s 4"]
    walkable: Bool[np.ndarray, " s"]


@njit(cache=True, nogil=True)
def open_space(solid_start, solid, width, height, climb):
    """The space above the walkable ones of the solid spans.

    Args:
        solid_start: First solid span of every column, and the number of spans.
        solid: Lowest voxel, voxel above and 1 where a robot can stand, of every solid span.
        width: Columns along x.
        height: Voxels that the robot needs.
        climb: Voxels that it climbs.
    """
    columns = len(solid_start) - 1
    count = int(solid[:, _WALKABLE].sum())
    start = np.zeros(columns + 1, dtype=np.int32)
    x, z = np.empty(count, dtype=np.int32), np.empty(count, dtype=np.int32)
    floor, ceiling = np.empty(count, dtype=np.int32), np.empty(count, dtype=np.int32)
    n = 0
    for column in range(columns):
        for i in range(solid_start[column], solid_start[column + 1]):
            if solid[i, _WALKABLE] == 1:
                top = solid[i + 1, _LOW] if i + 1 < solid_start[column + 1] else _OPEN
                x[n], z[n], floor[n] = column % width, column // width, solid[i, _HIGH]
                ceiling[n] = floor[n] + min(top - floor[n], _MOST_ROOM)
                n += 1
        start[column + 1] = n
    depth = columns // width
    neighbours = np.full((count, 4), NOTHING, dtype=np.int32)
    for i in range(count):
        for direction in range(4):
            nx, nz = x[i] + _DIRECTIONS[direction, 0], z[i] + _DIRECTIONS[direction, 1]
            if nx < 0 or nz < 0 or nx >= width or nz >= depth:
                continue
            column = nx + nz * width
            for k in range(start[column], min(start[column + 1], start[column] + _MOST_LAYERS)):
                room = min(ceiling[i], ceiling[k]) - max(floor[i], floor[k])
                if room >= height and abs(floor[k] - floor[i]) <= climb:
                    neighbours[i, direction] = k
                    break
    return OpenSpace(width, depth, start, x, z, floor, neighbours, np.ones(count, dtype=np.bool_))


@njit(cache=True, nogil=True)
def erode(space, radius):
    """Mark spans nearer than the robot's radius, in columns, to where it can't walk."""
    distance = _distances(space, 0xFF)
    for i in range(len(distance)):
        if distance[i] < 2 * radius:
            space.walkable[i] = False


@njit(cache=True, nogil=True)
def smooth_distances(space):
    """Distance of every span to a border, smoothed, and the greatest before smoothing.

    In half columns; inner eroded spans have a distance as well.
    """
    distance = _distances(space, _FAR)
    smooth = distance.copy()
    for i in range(len(distance)):
        own = distance[i]
        if own <= _STRAIGHT:
            continue
        total = own
        for direction in range(4):
            beside = space.neighbours[i, direction]
            if beside == NOTHING:
                total += 2 * own
                continue
            corner = space.neighbours[beside, (direction + 1) & 3]
            total += distance[beside] + (own if corner == NOTHING else distance[corner])
        smooth[i] = (total + 5) // 9
    return smooth, (distance.max() if len(distance) else 0)


@njit(cache=True, nogil=True)
def _distances(space, most):
    """Distance of every span to the nearest border between walkable and not, in half columns."""
    count = len(space.walkable)
    distance = np.full(count, most, dtype=np.int32)
    for i in range(count):
        alike = 0
        for direction in range(4):
            beside = space.neighbours[i, direction]
            if beside != NOTHING and space.walkable[beside] == space.walkable[i]:
                alike += 1
        if alike != 4:
            distance[i] = 0
    for i in range(count):
        _lower(space, distance, i, 0, 3)
        _lower(space, distance, i, 3, 2)
    for i in range(count - 1, -1, -1):
        _lower(space, distance, i, 2, 1)
        _lower(space, distance, i, 1, 0)
    return distance


@njit(cache=True, nogil=True)
def _lower(space, distance, i, direction, turn):
    """Lower a distance to those of a neighbour and of the one diagonally behind it."""
    beside = space.neighbours[i, direction]
    if beside == NOTHING:
        return
    distance[i] = min(distance[i], distance[beside] + _STRAIGHT)
    corner = space.neighbours[beside, turn]
    if corner != NOTHING:
        distance[i] = min(distance[i], distance[corner] + _DIAGONAL)
