"""Triangles as solid spans in columns of voxels (numba kernels), as ``RecastRasterization.cpp``."""

import math

import numpy as np
from numba import njit

_ONE = np.float32(1.0)
_ZERO = np.float32(0.0)
_HIGHEST = 8191
"""Voxels above each other that a span can count."""
# A function is compiled for every literal number that it is called with, but once for these.
_X, _Y, _Z = np.int64(0), np.int64(1), np.int64(2)
_REST, _ROW, _LEFT, _PART = np.int64(0), np.int64(1), np.int64(2), np.int64(3)
_TRIANGLE = np.int64(3)
_LOW, _HIGH, _WALKABLE, _NEXT = 0, 1, 2, 3


@njit(cache=True, nogil=True, error_model="numpy")
def fill(vertices, triangles, walkable, i, first, spans, used, free, parts, bounds, cells, climb):
    """Fill the spans of triangles, as long as there is room for them.

    Args:
        vertices: Corners, Habitat's frame, metres, single precision.
        triangles: Vertex numbers.
        walkable: 1 where a robot can stand on a triangle, as far as its slope tells.
        i: First triangle.
        first: Lowest span of the column at z and x; -1 where there is none.
        spans: Lowest voxel, voxel above, 1 where a robot can stand, and the span above it.
        used: Spans that have been used.
        free: First of those that are free again; each names the following one.
        parts: Room for four polygons of up to 12 corners.
        bounds: Lowest and highest corner of the voxels, metres.
        cells: Side of a column and height of a voxel, metres.
        climb: Voxels that the robot climbs; tops no farther apart count as one surface.

    Returns:
        The first triangle left, the new values of `used` and `free`, and how many spans that
        triangle may need.
    """
    low_x, low_y, low_z = bounds[0, 0], bounds[0, 1], bounds[0, 2]
    top = bounds[1, 1] - low_y
    cell, per_cell, per_height = cells[0], _ONE / cells[0], _ONE / cells[1]
    depth, width = first.shape
    rest, row, left, part = _REST, _ROW, _LEFT, _PART
    while i < len(triangles):
        for k in range(3):
            for axis in range(3):
                parts[rest, k, axis] = vertices[triangles[i, k], axis]
        least, most = _extent(parts, rest, _TRIANGLE, _X)
        needed = int((most - least) * per_cell) + 3
        least, most = _extent(parts, rest, _TRIANGLE, _Z)
        z = min(max(int((least - low_z) * per_cell), 0), depth - 1)
        z_last = min(max(int((most - low_z) * per_cell), 0), depth - 1)
        needed *= z_last - z + 1
        if used + needed > len(spans):
            return i, used, free, needed
        rest_count = _TRIANGLE
        while z <= z_last:
            border = low_z + np.float32(z) * cell + cell
            row_count, rest_count = _split(parts, rest, rest_count, row, left, border, _Z)
            rest, left = left, rest
            least, most = _extent(parts, row, row_count, _X)
            x = max(int((least - low_x) * per_cell), 0)
            x_last = min(max(int((most - low_x) * per_cell), 0), width - 1)
            while row_count >= 3 and x <= x_last:
                border = low_x + np.float32(x) * cell + cell
                count, row_count = _split(parts, row, row_count, part, left, border, _X)
                row, left = left, row
                least, most = _extent(parts, part, count, _Y)
                low, high = least - low_y, most - low_y
                if count >= 3 and high >= _ZERO and low <= top:
                    new = free
                    if new >= 0:
                        free = spans[new, _NEXT]
                    else:
                        new = used
                        used += 1
                    bottom = min(math.floor(max(low, _ZERO) * per_height), _HIGHEST)
                    above = max(math.ceil(min(high, top) * per_height), bottom + 1)
                    spans[new, _LOW], spans[new, _HIGH] = bottom, min(above, _HIGHEST)
                    spans[new, _WALKABLE] = walkable[i]
                    free = _insert(first, spans, z, x, new, free, climb)
                x += 1
            z += 1
        i += 1
    return i, used, free, 0


@njit(cache=True, nogil=True)
def _extent(parts, part, count, axis):
    low = high = parts[part, 0, axis]
    for k in range(1, count):
        low, high = min(low, parts[part, k, axis]), max(high, parts[part, k, axis])
    return low, high


@njit(cache=True, nogil=True, error_model="numpy")
def _split(parts, part, count, near, far, border, axis):
    """Cut a convex polygon; a corner on the border belongs to both parts. Returns their sizes."""
    nears, fars = 0, 0
    b = count - 1
    gap_b = border - parts[part, b, axis]
    for a in range(count):
        gap_a = border - parts[part, a, axis]
        cut = (gap_a >= _ZERO) != (gap_b >= _ZERO)
        if cut:
            s = gap_b / (gap_b - gap_a)
            for k in range(3):
                crossing = parts[part, b, k] + (parts[part, a, k] - parts[part, b, k]) * s
                parts[near, nears, k], parts[far, fars, k] = crossing, crossing
            nears, fars = nears + 1, fars + 1
        # A corner on the border beside a cut is the cut itself.
        if gap_a > _ZERO or (gap_a == _ZERO and not cut):
            for k in range(3):
                parts[near, nears, k] = parts[part, a, k]
            nears += 1
        if gap_a < _ZERO or (gap_a == _ZERO and not cut):
            for k in range(3):
                parts[far, fars, k] = parts[part, a, k]
            fars += 1
        b, gap_b = a, gap_a
    return nears, fars


@njit(cache=True, nogil=True)
def _insert(first, spans, z, x, new, free, climb):
    """Put a span into its column, joined with those that it touches; returns the free spans."""
    before, span = -1, first[z, x]
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
                first[z, x] = after
            spans[span, _NEXT] = free
            free = span
        span = after
    spans[new, _NEXT] = span
    if before >= 0:
        spans[before, _NEXT] = new
    else:
        first[z, x] = new
    return free
