"""Lines of sight on a grid of free and blocked cells (numba kernels).

Coordinates are integers in units of 1 / `UNITS` of a cell, so that lines of sight are exact.
"""

import numpy as np
from numba import njit
from numba.extending import register_jitable

UNITS = 1024


@register_jitable(no_cfunc_wrapper=True)
def _along_line(free, line, low, high, vertical):
    """Whether a robot can walk along a lattice line, from `low` to `high`."""
    left_open = True
    right_open = True
    for k in range(low // UNITS, (high - 1) // UNITS + 1):
        if vertical:
            left, right = free[k, line - 1], free[k, line]
        else:
            left, right = free[line - 1, k], free[line, k]
        left_open = left and left_open
        right_open = right and right_open
        if not (left_open or right_open):
            # One side closed here and the other before; both may be open again only from a cell
            # that is free on both sides, and there is none between them.
            return False
        if left and right:
            left_open = True
            right_open = True
    return True


@njit(cache=True, nogil=True)
def line_of_sight(free, x0, y0, x1, y1):
    """Whether the straight line between two points stays in the free space.

    `free` has a blocked border, so that every cell beside a point exists.
    """
    dx, dy = abs(x1 - x0), abs(y1 - y0)
    if dx == 0 and x0 % UNITS == 0:
        return dy == 0 or _along_line(free, x0 // UNITS, min(y0, y1), max(y0, y1), True)
    if dy == 0 and y0 % UNITS == 0:
        return dx == 0 or _along_line(free, y0 // UNITS, min(x0, x1), max(x0, x1), False)
    # The cells whose inside the line crosses, in order from its start.
    if x1 > x0 or dx == 0:
        step_x, column, last_column = 1, x0 // UNITS, (x1 - 1) // UNITS
        to_x = (column + 1) * UNITS - x0
    else:
        step_x, column, last_column = -1, (x0 - 1) // UNITS, x1 // UNITS
        to_x = x0 - column * UNITS
    if y1 > y0 or dy == 0:
        step_y, row, last_row = 1, y0 // UNITS, (y1 - 1) // UNITS
        to_y = (row + 1) * UNITS - y0
    else:
        step_y, row, last_row = -1, (y0 - 1) // UNITS, y1 // UNITS
        to_y = y0 - row * UNITS
    if dx == 0:
        last_column = column
    if dy == 0:
        last_row = row
    # The next border is crossed at to_x / dx or to_y / dy of the line; compared crosswise.
    at_x, at_y = to_x * dy, to_y * dx
    if dx == 0:
        at_x = np.int64(2) ** 62
    if dy == 0:
        at_y = np.int64(2) ** 62
    while True:
        if not free[row, column]:
            return False
        if row == last_row and column == last_column:
            return True
        if at_x < at_y:
            column += step_x
            at_x += UNITS * dy
        elif at_y < at_x:
            row += step_y
            at_y += UNITS * dx
        else:
            if not free[row, column + step_x] and not free[row + step_y, column]:
                return False
            column += step_x
            row += step_y
            at_x += UNITS * dy
            at_y += UNITS * dx
