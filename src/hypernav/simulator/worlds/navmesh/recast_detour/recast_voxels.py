"""Triangles as voxels, and the open space above those that a robot can stand on.

Solid spans in columns of voxels are those of ``RecastRasterization.cpp``, and those that a robot
can't stand on are marked as by ``RecastFilter.cpp``. The open space above the others is linked from
column to column as by ``rcBuildCompactHeightfield``, ``RecastArea.cpp`` and the distance field of
``RecastRegion.cpp``.

Habitat's frame, y up. Column ``x + z * width``; heights are counted in voxels from the lowest one.
Directions are 0: -x, 1: +z, 2: +x, 3: -z.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float32, Int32, Int64

from hypernav.simulator.worlds.navmesh.recast_detour.recast_kernels import fill, spread

_MOST_CORNERS = 12
_FIRST_ROOM = 1 << 16
_NEXT = 3
OPEN = 0xFFFF
"""Ceiling where there is nothing above a span."""
STEPS = ((-1, 0), (0, 1), (1, 0), (0, -1))
"""Columns along x and z to the neighbour in each direction."""
NOTHING = -1
"""A neighbour that there is none of."""
_MOST_ROOM = 0xFF
_MOST_LAYERS = 63
"""Spans of a column that its neighbours can be linked to."""
_FAR = 0xFFFF
_FAR_FROM_ROBOT = 0xFF
_STRAIGHT = 2


class Solid(NamedTuple):
    """Spans that triangles fill, column after column, each from below.

    Attributes:
        start: First span of every column, and the number of spans.
        low: Lowest voxel of every span.
        high: Voxel above every span.
        walkable: Whether a robot can stand on it.
    """

    start: Int64[np.ndarray, " starts"]
    low: Int32[np.ndarray, " s"]
    high: Int32[np.ndarray, " s"]
    walkable: Bool[np.ndarray, " s"]


def walkable_triangles(
    vertices: Float32[np.ndarray, "v 3"], triangles: Int32[np.ndarray, "t 3"], least_up: np.float32
) -> Bool[np.ndarray, " t"]:
    """Whether the upward part of each triangle's unit normal is more than this."""
    a = vertices[triangles[:, 0]]
    ux, uy, uz = (vertices[triangles[:, 1]] - a).T
    vx, vy, vz = (vertices[triangles[:, 2]] - a).T
    x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        return y * (np.float32(1.0) / np.sqrt(x * x + y * y + z * z)) > least_up


def rasterize(
    vertices: Float32[np.ndarray, "v 3"],
    triangles: Int32[np.ndarray, "t 3"],
    walkable: Bool[np.ndarray, " t"],
    bounds: Float32[np.ndarray, "2 3"],
    shape: tuple[int, int],
    cells: Float32[np.ndarray, " 2"],
    climb: int,
) -> Solid:
    """The spans that triangles fill.

    Args:
        vertices: Corners, Habitat's frame, metres.
        triangles: Vertex numbers.
        walkable: Whether a robot can stand on each triangle, as far as its slope tells.
        bounds: Lowest and highest corner of the voxels, metres.
        shape: Columns along z and along x.
        cells: Side of a column and height of a voxel, metres.
        climb: Voxels that the robot climbs; tops no farther apart count as one surface.
    """
    first = np.full(shape, -1, dtype=np.int32)
    spans = np.empty((_FIRST_ROOM, 4), dtype=np.int32)
    parts = np.empty((4, _MOST_CORNERS, 3), dtype=np.float32)
    stands = walkable.astype(np.int32)
    i, used, free = 0, 0, -1
    while i < len(triangles):
        i, used, free, needed = fill(
            vertices, triangles, stands, i, first, spans, used, free, parts, bounds, cells, climb
        )
        if i < len(triangles):
            room = np.empty((max(len(spans), needed), 4), dtype=np.int32)
            spans = np.concatenate([spans, room])
    return _in_order(first.ravel(), spans)


def _in_order(first: Int32[np.ndarray, " c"], spans: Int32[np.ndarray, "s 4"]) -> Solid:
    """The linked spans as arrays."""
    column = np.flatnonzero(first >= 0)
    span = first[column]
    columns, layers = [column], [span]
    while len(span):
        above = spans[span, _NEXT]
        column, span = column[above >= 0], above[above >= 0]
        columns.append(column)
        layers.append(span)
    start = np.zeros(len(first) + 1, dtype=np.int64)
    np.cumsum(np.bincount(np.concatenate(columns), minlength=len(first)), out=start[1:])
    order = np.empty(start[-1], dtype=np.int64)
    for layer, (column, span) in enumerate(zip(columns, layers, strict=True)):
        order[start[column] + layer] = span
    low, high, walkable, _ = spans[order].T
    return Solid(start, low.copy(), high.copy(), walkable == 1)


def columns_of(start: Int64[np.ndarray, " starts"]) -> Int64[np.ndarray, " s"]:
    """The column of every span."""
    return np.repeat(np.arange(len(start) - 1), np.diff(start))


def ceilings(solid: Solid) -> Int32[np.ndarray, " s"]:
    """Lowest voxel above the open space over every span."""
    above = np.append(solid.low[1:], np.int32(OPEN))
    above[solid.start[1:][np.diff(solid.start) > 0] - 1] = OPEN
    return above


def keep_low_obstacles(solid: Solid, climb: int) -> None:
    """Let the robot stand on what lies on a walkable span and is no higher than it climbs."""
    column = columns_of(solid.start)
    on_walkable = solid.walkable[:-1] & (column[1:] == column[:-1])
    low = np.flatnonzero(on_walkable & (np.diff(solid.high) <= climb)) + 1
    # One obstacle on another doesn't count: what is written now was not looked at.
    solid.walkable[low] = True


def drop_low_ceilings(solid: Solid, height: int) -> None:
    """Take away spans over which there is less room than the robot is high."""
    solid.walkable[ceilings(solid) - solid.high < height] = False


def drop_ledges(solid: Solid, width: int, height: int, climb: int) -> None:
    """Take away spans beside a drop, or on a slope, that is more than the robot climbs."""
    depth = (len(solid.start) - 1) // width
    ceiling = ceilings(solid)
    own = np.flatnonzero(solid.walkable)
    z, x = np.divmod(columns_of(solid.start)[own], width)
    floor, roof = solid.high[own], ceiling[own]
    drop = np.full(len(own), OPEN)
    lowest, highest = floor.copy(), floor.copy()
    for step_x, step_z in STEPS:
        nx, nz = x + step_x, z + step_z
        inside = (nx >= 0) & (nz >= 0) & (nx < width) & (nz < depth)
        column = np.where(inside, nx + nz * width, 0)
        begin, end = solid.start[column], np.where(inside, solid.start[column + 1], 0)
        # From below everything to the first span; beside the voxels there is nothing at all.
        top = np.full(len(own), OPEN)
        top[begin < end] = solid.low[begin[begin < end]]
        falls = ~inside | (np.minimum(roof, top) - np.maximum(floor, -climb) > height)
        drop[falls] = np.minimum(drop[falls], -climb - floor[falls])
        i, k = np.arange(len(own)), begin
        while len(i):
            i, k = i[k < end[i]], k[k < end[i]]
            beside = solid.high[k]
            fits = np.minimum(roof[i], ceiling[k]) - np.maximum(floor[i], beside) > height
            j, gap = i[fits], (beside - floor[i])[fits]
            drop[j] = np.minimum(drop[j], gap)
            near, level = j[np.abs(gap) <= climb], beside[fits][np.abs(gap) <= climb]
            lowest[near] = np.minimum(lowest[near], level)
            highest[near] = np.maximum(highest[near], level)
            k = k + 1
    solid.walkable[own[(drop < -climb) | (highest - lowest > climb)]] = False


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
