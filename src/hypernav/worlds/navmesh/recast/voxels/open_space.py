"""The open space above walkable spans, linked from column to column.

As ``rcBuildCompactHeightfield``, ``RecastArea.cpp`` and the distance field of ``RecastRegion.cpp``.
Directions are 0: -x, 1: +z, 2: +x, 3: -z.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Int32, Int64

from hypernav.worlds.navmesh.recast.voxels.distance_kernels import spread
from hypernav.worlds.navmesh.recast.voxels.filters import STEPS, ceilings, columns_of
from hypernav.worlds.navmesh.recast.voxels.rasterization import Solid

NOTHING = -1
"""A neighbour that there is none of."""

_MOST_ROOM = 0xFF
_MOST_LAYERS = 63
"""Spans of a column that its neighbours can be linked to."""
_FAR = 0xFFFF
_FAR_FROM_ROBOT = 0xFF
_STRAIGHT = 2


class OpenSpace(NamedTuple):
    """Spans of open space, column after column, each from below.

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
    start: Int64[np.ndarray, " starts"]
    x: Int32[np.ndarray, " s"]
    z: Int32[np.ndarray, " s"]
    floor: Int32[np.ndarray, " s"]
    neighbours: Int32[np.ndarray, "s 4"]
    walkable: Bool[np.ndarray, " s"]


def open_space(solid: Solid, width: int, height: int, climb: int) -> OpenSpace:
    """The space above the walkable ones of the solid spans.

    Args:
        solid: Solid spans.
        width: Columns along x.
        height: Voxels that the robot needs.
        climb: Voxels that it climbs.
    """
    columns = len(solid.start) - 1
    own = np.flatnonzero(solid.walkable)
    column = columns_of(solid.start)[own]
    start = np.zeros(columns + 1, dtype=np.int64)
    np.cumsum(np.bincount(column, minlength=columns), out=start[1:])
    z, x = np.divmod(column.astype(np.int32), np.int32(width))
    floor = solid.high[own]
    ceiling = floor + np.minimum(ceilings(solid)[own] - floor, _MOST_ROOM)
    neighbours = np.full((len(own), 4), NOTHING, dtype=np.int32)
    for direction, (step_x, step_z) in enumerate(STEPS):
        nx, nz = x + step_x, z + step_z
        i = np.flatnonzero((nx >= 0) & (nz >= 0) & (nx < width) & (nz < columns // width))
        beside = nx[i] + nz[i] * width
        k, end = start[beside], np.minimum(start[beside + 1], start[beside] + _MOST_LAYERS)
        while len(i):
            i, k, end = i[k < end], k[k < end], end[k < end]
            room = np.minimum(ceiling[i], ceiling[k]) - np.maximum(floor[i], floor[k])
            linked = (room >= height) & (np.abs(floor[k] - floor[i]) <= climb)
            neighbours[i[linked], direction] = k[linked]
            i, k, end = i[~linked], k[~linked] + 1, end[~linked]
    walkable = np.ones(len(own), dtype=np.bool_)
    return OpenSpace(width, columns // width, start, x, z, floor, neighbours, walkable)


def erode(space: OpenSpace, radius: int) -> None:
    """Mark spans nearer than the robot's radius, in columns, to where it can't walk."""
    space.walkable[_distances(space, _FAR_FROM_ROBOT) < 2 * radius] = False


def smooth_distances(space: OpenSpace) -> tuple[Int32[np.ndarray, " s"], int]:
    """Distance of every span to a border, smoothed, and the greatest before smoothing.

    In half columns; the inner ones of what was eroded have a distance as well.
    """
    distance = _distances(space, _FAR)
    total = distance.copy()
    for direction in range(4):
        beside = space.neighbours[:, direction]
        corner = space.neighbours[beside, (direction + 1) & 3]
        around = distance[beside] + np.where(corner == NOTHING, distance, distance[corner])
        total += np.where(beside == NOTHING, 2 * distance, around)
    smooth = np.where(distance > _STRAIGHT, (total + 5) // 9, distance)
    return smooth, int(distance.max(initial=0))


def _distances(space: OpenSpace, most: int) -> Int32[np.ndarray, " s"]:
    """Distance of every span to the nearest border between walkable and not, in half columns."""
    beside = space.neighbours
    alike = (beside != NOTHING) & (space.walkable[beside] == space.walkable[:, None])
    distance = np.where(alike.all(axis=1), np.int32(most), np.int32(0))
    spread(beside, distance)
    return distance
