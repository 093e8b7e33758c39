"""Components of a grid and straight movement on it (numba kernels).

Positions are in cells: x along columns, y along rows, cell ``[row, column]`` spans one unit.
"""

import numpy as np
from numba import njit
from numba.extending import register_jitable

_BACK_OFF = 1e-3
"""A blocked move ends this fraction of a cell before the contact, safely inside its cell."""
_GIVE = 0.5
"""Tolerance, cells. Cell borders are staircases where real walls are smooth; a robot that touches
one must not get stuck in a notch that does not really exist."""
_PAST = 1e-6
"""Distance beside a corner, cells, at which a walk that is pushed aside passes it."""


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
