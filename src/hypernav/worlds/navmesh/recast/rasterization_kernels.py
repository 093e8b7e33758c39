"""Triangles as solid spans in columns of voxels (numba kernels), as ``RecastRasterization.cpp``.

Habitat's frame, y up. Column ``x + z * width``; heights are counted in voxels from the lowest one.
"""

import math

import numpy as np
from numba import njit

_ONE = np.float32(1.0)
_ZERO = np.float32(0.0)
_HIGHEST = 8191
"""Largest height of a span, voxels."""
_MOST_CORNERS = 12
_X, _Z = 0, 2
_LOW, _HIGH, _WALKABLE, _NEXT = 0, 1, 2, 3


@njit(cache=True, nogil=True, error_model="numpy")
def walkable_triangles(vertices, triangles, least_up):
    """Whether the upward component of each triangle's unit normal is above a limit."""
    walkable = np.zeros(len(triangles), dtype=np.bool_)
    for i in range(len(triangles)):
        a, b, c = vertices[triangles[i, 0]], vertices[triangles[i, 1]], vertices[triangles[i, 2]]
        ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
        vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
        x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        walkable[i] = y * (_ONE / math.sqrt(x * x + y * y + z * z)) > least_up
    return walkable


@njit(cache=True, nogil=True, error_model="numpy")
def rasterize(vertices, triangles, walkable, bounds, width, depth, cell, cell_height, climb):
    """The spans that triangles fill.

    Args:
        vertices: Corners, Habitat's frame, metres, single precision.
        triangles: Vertex numbers.
        walkable: Whether each triangle's slope is walkable.
        bounds: Lowest and highest corner of the voxels, metres.
        width: Columns along x.
        depth: Columns along z.
        cell: Side of a column, metres.
        cell_height: Height of a voxel, metres.
        climb: Voxels that the robot climbs; tops within that distance count as one surface.

    Returns:
        First span of every column and the number of spans, and per span, from below: lowest voxel,
        voxel above it, and 1 where a robot can stand.
    """
    first = np.full(width * depth, -1, dtype=np.int32)
    spans = np.empty((4096, 4), dtype=np.int32)
    used, free = 0, -1
    low_x, low_y, low_z = bounds[0, 0], bounds[0, 1], bounds[0, 2]
    top = bounds[1, 1] - low_y
    per_cell, per_height = _ONE / cell, _ONE / cell_height
    rest, row, left, part = (
        np.empty((_MOST_CORNERS, 3), dtype=np.float32),
        np.empty((_MOST_CORNERS, 3), dtype=np.float32),
        np.empty((_MOST_CORNERS, 3), dtype=np.float32),
        np.empty((_MOST_CORNERS, 3), dtype=np.float32),
    )
    for i in range(len(triangles)):
        least_z, most_z = _fill(rest, vertices, triangles, i)
        z_first = min(max(int((least_z - low_z) * per_cell), 0), depth - 1)
        z_last = min(max(int((most_z - low_z) * per_cell), 0), depth - 1)
        rest_count = 3
        for z in range(z_first, z_last + 1):
            border = low_z + np.float32(z) * cell + cell
            row_count, rest_count = _split(rest, rest_count, row, left, border, _Z)
            rest, left = left, rest
            if row_count < 3:
                continue
            least_x, most_x = _extent(row, row_count, _X)
            x_first = int((least_x - low_x) * per_cell)
            if x_first >= width:
                continue
            x_first = max(x_first, 0)
            x_last = min(max(int((most_x - low_x) * per_cell), 0), width - 1)
            for x in range(x_first, x_last + 1):
                border = low_x + np.float32(x) * cell + cell
                count, row_count = _split(row, row_count, part, left, border, _X)
                row, left = left, row
                if count < 3:
                    continue
                low, high = _extent(part, count, 1)
                low, high = low - low_y, high - low_y
                if high < _ZERO or low > top:
                    continue
                bottom = min(max(math.floor(max(low, _ZERO) * per_height), 0), _HIGHEST)
                above = math.ceil(min(high, top) * per_height)
                if free >= 0:
                    new = free
                    free = spans[new, _NEXT]
                else:
                    if used == len(spans):
                        spans = np.concatenate((spans, np.empty_like(spans)))
                    new = used
                    used += 1
                spans[new, _LOW] = bottom
                spans[new, _HIGH] = min(max(above, bottom + 1), _HIGHEST)
                spans[new, _WALKABLE] = 1 if walkable[i] else 0
                free = _insert(first, spans, x + z * width, new, free, climb)
    return _in_order(first, spans)


@njit(cache=True, nogil=True)
def _fill(points, vertices, triangles, i):
    """Write a triangle's corners; returns their least and greatest z."""
    for k in range(3):
        for axis in range(3):
            points[k, axis] = vertices[triangles[i, k], axis]
    return _extent(points, 3, _Z)


@njit(cache=True, nogil=True)
def _extent(points, count, axis):
    low = high = points[0, axis]
    for k in range(1, count):
        low, high = min(low, points[k, axis]), max(high, points[k, axis])
    return low, high


@njit(cache=True, nogil=True, error_model="numpy")
def _split(points, count, near, far, border, axis):
    """Cut a convex polygon; a corner on the border belongs to both parts. Returns their sizes."""
    nears, fars = 0, 0
    b = count - 1
    gap_b = border - points[b, axis]
    for a in range(count):
        gap_a = border - points[a, axis]
        if (gap_a >= _ZERO) != (gap_b >= _ZERO):
            s = gap_b / (gap_b - gap_a)
            for k in range(3):
                crossing = points[b, k] + (points[a, k] - points[b, k]) * s
                near[nears, k], far[fars, k] = crossing, crossing
            nears, fars = nears + 1, fars + 1
            on_near, on_far = gap_a > _ZERO, gap_a < _ZERO
        else:
            on_near, on_far = gap_a >= _ZERO, gap_a <= _ZERO
        if on_near:
            for k in range(3):
                near[nears, k] = points[a, k]
            nears += 1
        if on_far:
            for k in range(3):
                far[fars, k] = points[a, k]
            fars += 1
        b, gap_b = a, gap_a
    return nears, fars


@njit(cache=True, nogil=True)
def _insert(first, spans, column, new, free, climb):
    """Insert a span into its column, merged with those that it touches; returns the free spans."""
    before, span = -1, first[column]
    while span >= 0 and spans[span, _LOW] <= spans[new, _HIGH]:
        after = spans[span, _NEXT]
        if spans[span, _HIGH] < spans[new, _LOW]:
            before = span
        else:
            spans[new, _LOW] = min(spans[new, _LOW], spans[span, _LOW])
            spans[new, _HIGH] = max(spans[new, _HIGH], spans[span, _HIGH])
            if spans[new, _HIGH] - spans[span, _HIGH] <= climb:
                spans[new, _WALKABLE] = max(spans[new, _WALKABLE], spans[span, _WALKABLE])
            if before >= 0:
                spans[before, _NEXT] = after
            else:
                first[column] = after
            spans[span, _NEXT] = free
            free = span
        span = after
    if before >= 0:
        spans[new, _NEXT] = spans[before, _NEXT]
        spans[before, _NEXT] = new
    else:
        spans[new, _NEXT] = first[column]
        first[column] = new
    return free


@njit(cache=True, nogil=True)
def _in_order(first, spans):
    """The linked spans as arrays: column after column, each from below."""
    start = np.zeros(len(first) + 1, dtype=np.int32)
    for column in range(len(first)):
        count, span = 0, first[column]
        while span >= 0:
            count += 1
            span = spans[span, _NEXT]
        start[column + 1] = start[column] + count
    ordered = np.empty((start[-1], 3), dtype=np.int32)
    for column in range(len(first)):
        span = first[column]
        for k in range(start[column], start[column + 1]):
            for field in range(3):
                ordered[k, field] = spans[span, field]
            span = spans[span, _NEXT]
    return start, ordered
