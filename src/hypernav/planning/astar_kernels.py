"""Cheapest paths over a grid of costs, compiled.

A cell's cost is the factor on the length of a path through it; 0 means closed. Paths are
8-connected and cut no corners.
"""

import math

import numpy as np
from numba import njit
from numba.extending import register_jitable

SQRT2 = math.sqrt(2.0)
BUCKETS_PER_CELL = 2
"""Number of buckets per cell of cost; with more, fewer cells are visited twice."""


@register_jitable(no_cfunc_wrapper=True)
def with_rim(costs, price):
    """Copy the costs into a flat array of zeros with room for a closed rim around them.

    With the rim, no step needs a test for the map's edge.

    Returns:
        The highest cost.
    """
    highest = np.float32(0.0)
    width = costs.shape[1] + 2
    for row in range(costs.shape[0]):
        for column in range(costs.shape[1]):
            cost = costs[row, column]
            price[(row + 1) * width + column + 1] = cost
            highest = max(highest, cost)
    return highest


@register_jitable(no_cfunc_wrapper=True)
def octile_to_box(row, column, box):
    """Length of the shortest 8-connected path to a box over open cells of cost 1, in cells."""
    down = max(box[0] - row, 0, row - box[1])
    across = max(box[2] - column, 0, column - box[3])
    return max(down, across) + (SQRT2 - 1.0) * min(down, across)


@njit(cache=True, nogil=True)
def expand(costs, start_row, start_column, targets, box, slack):
    """Costs of the paths from a cell to others, until a target is reached.

    A* with buckets instead of a heap: waiting cells of similar estimated cost share a list, and a
    list is worked off until it stays empty. So the result is exact, and taking out, putting in and
    moving a cell take constant time. With a box that holds the whole grid it is Dijkstra's search.

    Args:
        costs: float32 (rows, columns), at least 1 where open, 0 where closed.
        start_row: Row of the start, an open cell.
        start_column: Column of the start.
        targets: uint8 (rows, columns), not 0 at the cells to reach.
        box: Lowest and highest row, lowest and highest column of the targets.
        slack: Cost up to which the search goes on after it reached a target, in cells.

    Returns:
        Flat arrays with a rim of one cell around the grid: float32, the cost of the path to every
        cell that was looked at, in cells, infinite for others; int32, the cell before it, -1 at
        the start, undefined for others. Then the flat index of the cheapest target, -1 if there is
        no path.
    """
    width = costs.shape[1] + 2
    size = width * (costs.shape[0] + 2)
    price = np.zeros(size, dtype=np.float32)
    highest = with_rim(costs, price)
    least = octile_to_box(start_row, start_column, box)
    spent = np.full(size, np.float32(np.inf), dtype=np.float32)
    estimate = np.empty(size, dtype=np.float32)
    came_from = np.empty(size, dtype=np.int32)
    # Every bucket is a doubly linked list through its cells; -1 is "none".
    following = np.empty(size, dtype=np.int32)
    preceding = np.empty(size, dtype=np.int32)
    bucket_of = np.empty(size, dtype=np.int32)
    buckets = int(BUCKETS_PER_CELL * SQRT2 * (highest + 1.0)) + 3
    heads = np.full(buckets, -1, dtype=np.int32)

    start = (start_row + 1) * width + start_column + 1
    spent[start], estimate[start] = 0.0, least
    heads[0], bucket_of[start] = start, 0
    came_from[start], following[start] = -1, -1
    waiting, level, found, last_level = 1, 0, -1, 0
    # Four straight steps, and to the left of each of them the side of a diagonal one.
    steps = np.array([1, -1, width, -width])
    sides = np.array([width, -width, -1, 1])
    while waiting > 0:
        cell = heads[level % buckets]
        if cell < 0:
            if found >= 0 and level >= last_level:
                break
            level += 1
            continue
        heads[level % buckets] = following[cell]
        if following[cell] >= 0:
            preceding[following[cell]] = -1
        bucket_of[cell] = -1
        waiting -= 1
        if targets[cell // width - 1, cell % width - 1] > 0:
            if found < 0:
                last_level = level + int(slack * BUCKETS_PER_CELL)
            if found < 0 or spent[cell] < spent[found]:
                found = cell
        for k in range(8):
            other = cell + steps[k >> 1]
            length = np.float32(0.5)
            if k & 1:
                side = sides[k >> 1]
                if price[other] <= 0.0 or price[cell + side] <= 0.0:
                    continue
                other += side
                length = np.float32(0.5 * SQRT2)
            if price[other] <= 0.0:
                continue
            cost = spent[cell] + length * (price[cell] + price[other])
            if not cost < spent[other]:
                continue
            if spent[other] == np.inf:  # never looked at before, so nothing is known of it
                bucket_of[other] = -1
                # Never longer than the true rest of the path, so A* is exact.
                estimate[other] = octile_to_box(other // width - 1, other % width - 1, box)
            spent[other] = cost
            came_from[other] = cell
            # Rounding may put a cell just before the present list.
            new = max(int((cost + estimate[other] - least) * BUCKETS_PER_CELL), level)
            old = bucket_of[other]
            if old == new:
                continue
            if old >= 0:
                before, after = preceding[other], following[other]
                if before >= 0:
                    following[before] = after
                else:
                    heads[old % buckets] = after
                if after >= 0:
                    preceding[after] = before
                waiting -= 1
            head = heads[new % buckets]
            preceding[other], following[other], bucket_of[other] = -1, head, new
            if head >= 0:
                preceding[head] = other
            heads[new % buckets] = other
            waiting += 1
    return spent, came_from, found


@njit(cache=True, nogil=True)
def path_back(came_from, cell, width):
    """The cells from the start of `expand` to a cell, ``[row, column]`` without the rim."""
    length, at = 0, cell
    while at >= 0:
        length += 1
        at = came_from[at]
    path = np.empty((length, 2), dtype=np.int64)
    at = cell
    for i in range(length - 1, -1, -1):
        path[i, 0], path[i, 1] = at // width - 1, at % width - 1
        at = came_from[at]
    return path
