"""Distances over open floor and lines of sight over the map's cells, compiled."""

import math

import numpy as np
from numba import njit
from numba.extending import register_jitable

from hypernav.search.mapping.top_down_kernels import OCCUPIED, UNKNOWN

SQRT2 = math.sqrt(2.0)
_ALL = np.empty((0, 2), np.int64)


def travel_cells(is_open, start_row, start_column, wanted=None):
    """Length of the shortest 8-connected path from a cell to every other, in cells.

    Dijkstra with three lists instead of a heap: no step is shorter than one cell, so all waiting
    cells whose distance lies in the same unit interval are final at once (Denardo and Fox, 1979).
    Paths never cut the corner of a closed cell.

    Args:
        is_open: uint8 (rows, columns), not 0 where the robot may be.
        start_row: Row of the start, an open cell.
        start_column: Column of the start.
        wanted: int64 (n, 2), rows and columns of the only cells whose distances are wanted; None
            for all.

    Returns:
        float32 (rows, columns), cells; infinite where no path leads, perhaps where none is wanted.
    """
    return _travel_cells(is_open, start_row, start_column, _ALL if wanted is None else wanted)


@njit(cache=True, nogil=True)
def _travel_cells(is_open, start_row, start_column, wanted):
    # One type for both cases, so that it is compiled once.
    rows, columns = is_open.shape
    width = columns + 2
    # With a closed rim around the map, no step needs a test for its edge.
    walkable = np.zeros(width * (rows + 2), dtype=np.uint8)
    for row in range(rows):
        first = (row + 1) * width + 1
        for column in range(columns):
            walkable[first + column] = is_open[row, column]
    distance = np.full(walkable.size, np.float32(np.inf), dtype=np.float32)
    waiting = np.empty((3, walkable.size), dtype=np.int32)
    counts = np.zeros(3, dtype=np.int64)
    start = (start_row + 1) * width + start_column + 1
    distance[start] = 0.0
    waiting[0, 0], counts[0] = start, 1
    # Four straight steps, and to the left of each of them the side of a diagonal one.
    steps = np.array([1, -1, width, -width])
    sides = np.array([width, -width, -1, 1])
    level = 0
    while counts[0] + counts[1] + counts[2] > 0:
        if len(wanted) > 0 and are_nearer(distance, wanted, width, level):
            break
        now = level % 3
        for i in range(counts[now]):
            cell = waiting[now, i]
            here = distance[cell]
            # A cell may wait in a later list too, from before its distance shrank.
            if int(here) != level:
                continue
            for k in range(4):
                straight = cell + steps[k]
                if walkable[straight] == 0:
                    continue
                side = sides[k]
                for diagonal in range(2):
                    if diagonal and (walkable[cell + side] == 0 or walkable[straight + side] == 0):
                        continue
                    other = straight + side * diagonal
                    there = here + np.float32(SQRT2 if diagonal else 1.0)
                    if there < distance[other]:
                        bucket = int(there) % 3
                        if not distance[other] < int(there) + 1:
                            waiting[bucket, counts[bucket]] = other
                            counts[bucket] += 1
                        distance[other] = there
        counts[now] = 0
        level += 1
    inner = distance.reshape(rows + 2, width)[1:-1, 1:-1]
    return inner.copy()


@register_jitable
def are_nearer(distance, cells, width, level):
    """Whether the distances of all given cells are below a level, in cells."""
    for i in range(len(cells)):
        if not distance[(cells[i, 0] + 1) * width + cells[i, 1] + 1] < level:
            return False
    return True


@njit(cache=True, nogil=True)
def nearest_open_cell(is_open, row, column, within):
    """The open cell nearest to a cell, which may lie outside; (-1, -1) if none is near.

    Args:
        is_open: uint8 (rows, columns), not 0 where open.
        row: Row of the cell.
        column: Column of the cell.
        within: Number of rows and columns to look at on each side.

    Returns:
        Row and column; among equally near ones the lowest, leftmost.
    """
    rows, columns = is_open.shape
    best, best_row, best_column = 2 * (within + 1) ** 2, -1, -1
    for r in range(max(row - within, 0), min(row + within + 1, rows)):
        for c in range(max(column - within, 0), min(column + within + 1, columns)):
            away = (r - row) ** 2 + (c - column) ** 2
            if is_open[r, c] and away < best:
                best, best_row, best_column = away, r, c
    return best_row, best_column


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
