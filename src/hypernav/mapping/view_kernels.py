"""Lines of sight over the map's cells, compiled."""

import math

import numpy as np
from numba import njit

from hypernav.mapping.top_down.integrate_kernels import OCCUPIED, UNKNOWN


@njit(cache=True, nogil=True)
def unknown_in_view(cells, at, reach, rays, open_cells, side):
    """The unknown cells that a camera turned all around would see from some cells.

    Rays end at obstacles and at the end of their reach. The farther they go through the unknown,
    the likelier they are taken to meet something hidden there.

    Args:
        cells: uint8 (rows, columns), states of the map's cells; no ray may reach beyond them.
        at: int64 (n, 2), ``[row, column]`` of the cells that are looked from.
        reach: Length of a ray, cells.
        rays: Number of rays of a full turn.
        open_cells: Length of the unknown after which 1 of e rays still goes on, cells.
        side: Side of the patches that unknown cells are counted in, cells.

    Returns:
        bool (n, patches along y, patches along x), what each cell sees; and float64 (patches along
        y, patches along x), the largest probability with which one of them sees the patch.
    """
    height, width = cells.shape
    shape = ((height + side - 1) // side, (width + side - 1) // side)
    shows = np.zeros((len(at), *shape), dtype=np.bool_)
    chance = np.zeros(shape)
    goes_on = np.exp(-np.arange(1, reach + 1) / open_cells)
    ups, rights = np.empty(rays), np.empty(rays)
    for ray in range(rays):
        angle = 2.0 * math.pi * ray / rays
        ups[ray], rights[ray] = math.sin(angle), math.cos(angle)
    for k in range(len(at)):
        for ray in range(rays):
            up, right = ups[ray], rights[ray]
            row, column, through = at[k, 0], at[k, 1], 0
            y, x = row + 0.5, column + 0.5
            for _ in range(reach):
                y += up
                x += right
                last_row, last_column = row, column
                row, column = int(y), int(x)
                state = cells[row, column]
                # A ray does not pass between two obstacles that touch at a corner either.
                if state == OCCUPIED or (
                    cells[last_row, column] == OCCUPIED and cells[row, last_column] == OCCUPIED
                ):
                    break
                if state == UNKNOWN:
                    patch = row // side, column // side
                    shows[k, patch[0], patch[1]] = True
                    chance[patch] = max(chance[patch], goes_on[through])
                    through += 1
    return shows, chance


@njit(cache=True, nogil=True)
def clear_lines(cells, own, origin, size, starts, legs, shares):
    """Whether straight lines meet no obstacle.

    Args:
        cells: uint8 (rows, columns), states of the map's cells; beyond them nothing hides.
        own: bool (rows, columns), cells that hide nothing.
        origin: float64 (2,), lower left corner of the map, ``(x, y)``, metres.
        size: Side of a cell, metres.
        starts: float64 (n, 2), start ``(x, y)`` of every line, metres.
        legs: float64 (n, 2), vector from there to its end, metres.
        shares: float64 (samples,), positions along a line at which cells are tested, 0 to 1.

    Returns:
        bool (n,), whether each line is clear.
    """
    rows, columns = cells.shape
    clear = np.ones(len(starts), dtype=np.bool_)
    for k in range(len(starts)):
        for share in shares:
            column = math.floor((starts[k, 0] + share * legs[k, 0] - origin[0]) / size)
            row = math.floor((starts[k, 1] + share * legs[k, 1] - origin[1]) / size)
            inside = 0 <= row < rows and 0 <= column < columns
            if inside and cells[row, column] == OCCUPIED and not own[row, column]:
                clear[k] = False
                break
    return clear
