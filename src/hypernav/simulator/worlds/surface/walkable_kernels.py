"""Solid columns of a scene, and the parts of a grid and straight moves on it (numba kernels).

A column is one cell of the floor plan, as in Recast's height fields. Every triangle leaves in each
column that it crosses the interval of heights that it covers there; intervals that touch become
solids; the top of a solid with enough clearance above it is a floor to stand on.

Positions on a grid are in cells: x along columns, y along rows, cell ``[row, column]`` spans one
unit.
"""

import numpy as np
from numba import njit
from numba.extending import register_jitable

_INWARD_M = 1e-4
"""Distance by which triangles are moved against their normal, so that a wall face exactly on the
border of two columns fills the one behind it, not the one in front."""

_TOUCHING_M = 0.01
"""Intervals closer than this are one solid."""
_BACK_OFF = 1e-3
"""A blocked move ends this fraction of a cell before the contact, safely inside its cell."""
_GIVE = 0.5
"""Tolerance, cells. Cell borders are staircases where real walls are smooth; a robot that touches
one must not get stuck in a notch that does not really exist."""
_PAST = 1e-6
"""Distance beside a corner, cells, at which a walk that is pushed aside passes it."""


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


@njit(cache=True, nogil=True)
def label_components(heights, max_step):
    """Number the parts of a height map that steps connect, 4-connected; NaN is nowhere.

    Returns:
        Part of every cell (-1 where there is none) and the number of cells of every part.
    """
    rows, columns = heights.shape
    labels = np.full((rows, columns), -1, dtype=np.int32)
    stack = np.empty(rows * columns, dtype=np.int64)
    sizes = np.empty(rows * columns, dtype=np.int64)
    n = 0
    for seed in range(rows * columns):
        if labels[seed // columns, seed % columns] >= 0:
            continue
        if np.isnan(heights[seed // columns, seed % columns]):
            continue
        labels[seed // columns, seed % columns] = n
        stack[0] = seed
        depth = 1
        size = 0
        while depth > 0:
            depth -= 1
            row, column = stack[depth] // columns, stack[depth] % columns
            size += 1
            for d_row, d_column in ((0, 1), (1, 0), (0, -1), (-1, 0)):
                r, c = row + d_row, column + d_column
                if r < 0 or c < 0 or r >= rows or c >= columns or labels[r, c] >= 0:
                    continue
                # The comparison is False for NaN.
                if abs(heights[r, c] - heights[row, column]) <= max_step:
                    labels[r, c] = n
                    stack[depth] = r * columns + c
                    depth += 1
        sizes[n] = size
        n += 1
    return labels, sizes[:n].copy()


@njit(cache=True, nogil=True)
def mark_cliffs(heights, max_step):
    """Cells with a neighbour (8-connected) that is floor but too much higher or lower."""
    rows, columns = heights.shape
    cliffs = np.zeros((rows, columns), dtype=np.bool_)
    for row in range(rows):
        for column in range(columns):
            for d_row in range(-1, 2):
                for d_column in range(-1, 2):
                    r, c = row + d_row, column + d_column
                    if r < 0 or c < 0 or r >= rows or c >= columns:
                        continue
                    if abs(heights[r, c] - heights[row, column]) > max_step:
                        cliffs[row, column] = True
    return cliffs


@register_jitable(no_cfunc_wrapper=True)
def _is_free(free, row, column):
    return 0 <= row < free.shape[0] and 0 <= column < free.shape[1] and free[row, column]


@register_jitable(no_cfunc_wrapper=True)
def _inside(x, y, row, column):
    """The nearest point strictly inside a cell."""
    margin = 1e-9
    end_x = min(max(x, column + margin), column + 1 - margin)
    end_y = min(max(y, row + margin), row + 1 - margin)
    return end_x, end_y


@register_jitable(no_cfunc_wrapper=True)
def _cells_to_corner(free, row, column, d_row, d_column, across_row, across_column):
    """Number of cells along a wall to its corner; 0 if an obstacle comes before.

    Args:
        free: Free cells.
        row: Row of the cell beside the wall.
        column: Column of the cell beside the wall.
        d_row: Step in rows along the wall.
        d_column: Step in columns along the wall.
        across_row: Step in rows into the wall.
        across_column: Step in columns into the wall.
    """
    cells = 1
    while _is_free(free, row + cells * d_row, column + cells * d_column):
        if _is_free(
            free, row + cells * d_row + across_row, column + cells * d_column + across_column
        ):
            return cells
        cells += 1
    return 0


@njit(cache=True, nogil=True)
def walk(free, x, y, dx, dy):
    """Walk straight until the end or the border of the free cells.

    A walk through the corner where four cells meet needs one free cell beside it: it never passes
    between two blocked ones. A corner that it would only graze pushes it aside, by `_GIVE` in total
    at most.

    Returns:
        End position, and whether it is the target, or where the walk was pushed to beside it.
    """
    row, column = int(np.floor(y)), int(np.floor(x))
    if not _is_free(free, row, column):
        return x, y, False
    step_x = 1 if dx > 0 else -1
    step_y = 1 if dy > 0 else -1
    length = np.hypot(dx, dy)
    # Fraction of the walk from one border to the next.
    span_x = 1.0 / abs(dx) if dx != 0.0 else np.inf
    span_y = 1.0 / abs(dy) if dy != 0.0 else np.inf
    give = _GIVE
    while row != int(np.floor(y + dy)) or column != int(np.floor(x + dx)):
        # Fraction of the walk at which the next border is crossed.
        t_x = ((column + (step_x > 0)) - x) / dx if dx != 0.0 else np.inf
        t_y = ((row + (step_y > 0)) - y) / dy if dy != 0.0 else np.inf
        t = min(t_x, t_y)
        if t > 1.0:  # Rounding: the target lies on the border.
            return *_inside(x + dx, y + dy, row, column), True
        along_x = t_x < t_y or (t_x == t_y and _is_free(free, row, column + step_x))
        r, c = (row, column + step_x) if along_x else (row + step_y, column)
        if _is_free(free, r, c):
            row, column = r, c
            continue
        if along_x:
            cells = _cells_to_corner(free, row, column, step_y, 0, 0, step_x)
            corner = t_y + (cells - 1) * span_y
        else:
            cells = _cells_to_corner(free, row, column, 0, step_x, step_y, 0)
            corner = t_x + (cells - 1) * span_x
        passes = cells > 0 and corner <= 1.0
        push = (corner - t) * abs(dx * dy) / length + _PAST
        if not passes or push > give:
            t = max(t - _BACK_OFF / length, 0.0)
            return *_inside(x + t * dx, y + t * dy, row, column), False
        # Away from the blocked cell, at right angles to the walk.
        give -= push
        side = -1.0 if along_x else 1.0
        x += side * push * step_x * abs(dy) / length
        y -= side * push * step_y * abs(dx) / length
    return x + dx, y + dy, True


@njit(cache=True, nogil=True)
def slide(free, x, y, dx, dy):
    """End of a walk that may slide along walls.

    As Detour's ``moveAlongSurface``: of the area connected to the start within the circle whose
    diameter is the walk, the point nearest to the target.
    """
    end_x, end_y, arrived = walk(free, x, y, dx, dy)
    if arrived or not _is_free(free, int(np.floor(y)), int(np.floor(x))):
        return end_x, end_y
    middle_x, middle_y = x + dx / 2.0, y + dy / 2.0
    radius = np.hypot(dx, dy) / 2.0
    reach = int(np.ceil(radius)) + 2
    size = 2 * reach + 1
    first_row, first_column = int(np.floor(middle_y)) - reach, int(np.floor(middle_x)) - reach
    seen = np.zeros((size, size), dtype=np.bool_)
    stack = np.empty((size * size, 2), dtype=np.int64)
    stack[0, 0], stack[0, 1] = int(np.floor(y)) - first_row, int(np.floor(x)) - first_column
    seen[stack[0, 0], stack[0, 1]] = True
    depth = 1
    best = np.hypot(x + dx - end_x, y + dy - end_y)
    while depth > 0:
        depth -= 1
        r, c = stack[depth, 0], stack[depth, 1]
        row, column = first_row + r, first_column + c
        near_x = min(max(x + dx, column + _BACK_OFF), column + 1 - _BACK_OFF)
        near_y = min(max(y + dy, row + _BACK_OFF), row + 1 - _BACK_OFF)
        away = np.hypot(x + dx - near_x, y + dy - near_y)
        inside = np.hypot(near_x - middle_x, near_y - middle_y) <= radius
        if inside and away < best:
            best, end_x, end_y = away, near_x, near_y
        for d_row, d_column in ((0, 1), (1, 0), (0, -1), (-1, 0)):
            r2, c2 = r + d_row, c + d_column
            if r2 < 0 or c2 < 0 or r2 >= size or c2 >= size or seen[r2, c2]:
                continue
            row2, column2 = first_row + r2, first_column + c2
            gap_x = max(column2 - middle_x, 0.0, middle_x - column2 - 1)
            gap_y = max(row2 - middle_y, 0.0, middle_y - row2 - 1)
            if np.hypot(gap_x, gap_y) <= radius and _is_free(free, row2, column2):
                seen[r2, c2] = True
                stack[depth, 0], stack[depth, 1] = r2, c2
                depth += 1
    return end_x, end_y
