"""Height field of solid columns from triangles, as in Recast (numba kernels).

A column is one cell of the floor plan. Every triangle leaves in each column that it crosses the
interval of heights that it covers there; intervals that touch become solids; the top of a solid
with enough clearance above it is a floor to stand on.
"""

import numpy as np
from numba import njit
from numba.extending import register_jitable

_INWARD_M = 1e-4
"""Distance by which triangles are moved against their normal, so that a wall face exactly on the
border of two columns fills the one behind it, not the one in front."""

_TOUCHING_M = 0.01
"""Intervals closer than this are one solid."""


@register_jitable(no_cfunc_wrapper=True)
def _split(polygon, count, axis, value, below, above):
    """Cut a convex polygon by the plane ``axis = value``; returns both parts' corner counts."""
    n_below = 0
    n_above = 0
    for k in range(count):
        following = k + 1 if k + 1 < count else 0
        here = polygon[k, axis] - value
        there = polygon[following, axis] - value
        if here <= 0.0:
            for i in range(3):
                below[n_below, i] = polygon[k, i]
            n_below += 1
        if here >= 0.0:
            for i in range(3):
                above[n_above, i] = polygon[k, i]
            n_above += 1
        if (here < 0.0 < there) or (there < 0.0 < here):
            t = here / (here - there)
            for i in range(3):
                corner = polygon[k, i] + t * (polygon[following, i] - polygon[k, i])
                below[n_below, i] = corner
                above[n_above, i] = corner
            below[n_below, axis] = value
            above[n_above, axis] = value
            n_below += 1
            n_above += 1
    return n_below, n_above


@register_jitable(no_cfunc_wrapper=True)
def _first_last(polygon, count, axis, cells):
    """First and last cell that a polygon covers along an axis, borders to the lower side."""
    low = polygon[0, axis]
    high = low
    for k in range(1, count):
        low = min(low, polygon[k, axis])
        high = max(high, polygon[k, axis])
    first = max(int(np.floor(low)), 0)
    last = min(max(int(np.ceil(high)) - 1, first), cells - 1)
    return first, last


@register_jitable(no_cfunc_wrapper=True)
def _heights(polygon, count):
    low = polygon[0, 2]
    high = low
    for k in range(1, count):
        low = min(low, polygon[k, 2])
        high = max(high, polygon[k, 2])
    return low, high


@register_jitable(no_cfunc_wrapper=True)
def _grown(array):
    longer = np.empty(array.size * 2, dtype=array.dtype)
    for k in range(array.size):
        longer[k] = array[k]
    return longer


@register_jitable(no_cfunc_wrapper=True)
def _normal(triangle):
    """Unit normal of a triangle; zero if it has no area."""
    ux, uy, uz = (
        triangle[1, 0] - triangle[0, 0],
        triangle[1, 1] - triangle[0, 1],
        triangle[1, 2] - triangle[0, 2],
    )
    vx, vy, vz = (
        triangle[2, 0] - triangle[0, 0],
        triangle[2, 1] - triangle[0, 1],
        triangle[2, 2] - triangle[0, 2],
    )
    x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    length = np.sqrt(x * x + y * y + z * z)
    if not length > 1e-12:
        return 0.0, 0.0, 0.0
    return x / length, y / length, z / length


@njit(cache=True, nogil=True)
def rasterise(vertices, faces, cell_m, origin_x, origin_y, rows, columns, flat_cosine, most):
    """Heights that triangles cover in each column.

    Returns:
        Four arrays, one entry per triangle and column it crosses: the column's number
        (``row * columns + column``), lowest and highest z there, whether the triangle is flat
        enough to stand on. At least `most` entries mean that there are too many.
    """
    where = np.empty(max(faces.shape[0] * 2, 1024), dtype=np.int32)
    low = np.empty(where.size, dtype=np.float32)
    high = np.empty(where.size, dtype=np.float32)
    flat = np.empty(where.size, dtype=np.bool_)
    n = 0
    triangle = np.empty((12, 3))
    band = np.empty((12, 3))
    rest = np.empty((12, 3))
    piece = np.empty((12, 3))
    remainder = np.empty((12, 3))
    for f in range(faces.shape[0]):
        for corner in range(3):
            for i in range(3):
                triangle[corner, i] = vertices[faces[f, corner], i]
        normal_x, normal_y, normal_z = _normal(triangle)
        if normal_x == 0.0 and normal_y == 0.0 and normal_z == 0.0:
            continue
        is_flat = abs(normal_z) >= flat_cosine
        for corner in range(3):
            x = triangle[corner, 0] - _INWARD_M * normal_x
            y = triangle[corner, 1] - _INWARD_M * normal_y
            triangle[corner, 0] = (x - origin_x) / cell_m
            triangle[corner, 1] = (y - origin_y) / cell_m
        first_row, last_row = _first_last(triangle, 3, 1, rows)
        count = 3
        for row in range(first_row, last_row + 1):
            if row < last_row:
                n_band, count = _split(triangle, count, 1, row + 1.0, band, rest)
                triangle, rest = rest, triangle
            else:
                n_band = count
                band, triangle = triangle, band
            if n_band == 0:
                continue
            first, last = _first_last(band, n_band, 0, columns)
            for column in range(first, last + 1):
                if column < last:
                    n_piece, n_band = _split(band, n_band, 0, column + 1.0, piece, remainder)
                    band, remainder = remainder, band
                else:
                    n_piece = n_band
                    piece, band = band, piece
                if n_piece == 0:
                    continue
                if n == most:
                    return where, low, high, flat
                if n == where.size:
                    where, low, high, flat = _grown(where), _grown(low), _grown(high), _grown(flat)
                where[n] = row * columns + column
                low[n], high[n] = _heights(piece, n_piece)
                flat[n] = is_flat
                n += 1
    return where[:n], low[:n], high[:n], flat[:n]


@register_jitable(no_cfunc_wrapper=True)
def _by_column(upwards, where, cells):
    """Sort intervals by column, keeping their order within it; returns every column's start."""
    start = np.zeros(cells + 1, dtype=np.int64)
    for k in range(where.size):
        start[where[k] + 1] += 1
    for k in range(cells):
        start[k + 1] += start[k]
    following = start.copy()
    order = np.empty(where.size, dtype=np.int64)
    for k in upwards:
        order[following[where[k]]] = k
        following[where[k]] += 1
    return start, order


@register_jitable(no_cfunc_wrapper=True)
def _solids(order, low, high, flat, max_step, bottoms, tops, standing):
    """Merge one column's intervals, from low to high, into solids; returns their number.

    A solid can be stood on where a flat interval ends at most a step below its top: what lies
    higher than that is an obstacle.
    """
    n = 0
    flat_top = -np.inf
    for k in order:
        if n == 0 or low[k] > tops[n - 1] + _TOUCHING_M:
            bottoms[n], tops[n], standing[n] = low[k], high[k], False
            flat_top = -np.inf
            n += 1
        bottoms[n - 1] = min(bottoms[n - 1], low[k])
        tops[n - 1] = max(tops[n - 1], high[k])
        if flat[k]:
            flat_top = max(flat_top, np.float64(high[k]))
        standing[n - 1] = flat_top >= tops[n - 1] - max_step
    for k in range(1, n):
        # A robot steps onto a low object that floats above a floor as onto one that stands on it.
        if not standing[k] and standing[k - 1] and tops[k] - tops[k - 1] <= max_step:
            standing[k] = True
    return n


@njit(cache=True, nogil=True)
def floors_of_columns(upwards, where, low, high, flat, cells, max_step, clearance):
    """Floors to stand on: column, height and whether something is overhead, in order of columns.

    Args:
        upwards: Numbers of the intervals in order of their lower ends, to the millimetre.
        where: Columns of the intervals, from `rasterise`, as the following three.
        low: Lowest z of the intervals, metres.
        high: Highest z of the intervals, metres.
        flat: Whether the intervals are flat enough to stand on.
        cells: Number of columns.
        max_step: Highest step that the robot takes, metres.
        clearance: Free height needed above a floor, metres.
    """
    start, order = _by_column(upwards, where, cells)
    longest = 1
    for cell in range(cells):
        longest = max(longest, start[cell + 1] - start[cell])
    bottoms = np.empty(longest, dtype=np.float32)
    tops = np.empty(longest, dtype=np.float32)
    standing = np.empty(longest, dtype=np.bool_)
    floor_cell = np.empty(max(cells, 1), dtype=np.int32)
    floor_z = np.empty(max(cells, 1), dtype=np.float32)
    covered = np.empty(max(cells, 1), dtype=np.bool_)
    n = 0
    for cell in range(cells):
        intervals = order[start[cell] : start[cell + 1]]
        count = _solids(intervals, low, high, flat, max_step, bottoms, tops, standing)
        for k in range(count):
            room = bottoms[k + 1] - tops[k] if k + 1 < count else np.inf
            if standing[k] and room >= clearance:
                if n == floor_cell.size:
                    floor_cell, floor_z = _grown(floor_cell), _grown(floor_z)
                    covered = _grown(covered)
                floor_cell[n], floor_z[n], covered[n] = cell, tops[k], k + 1 < count
                n += 1
    return floor_cell[:n], floor_z[:n], covered[:n]
