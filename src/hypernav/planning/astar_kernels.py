"""A* on a grid of costs, and lines of sight (numba kernels).

A cell's cost is the factor on the length of a way through it; 0 means closed. Ways are 8-connected
and never cut the corner of a closed cell.
"""

import math

import numpy as np
from numba import njit

_SQRT2 = math.sqrt(2.0)


@njit(cache=True, nogil=True)
def _push(heap_keys, heap_cells, size, key, cell):
    i = size
    while i > 0:
        parent = (i - 1) // 2
        if heap_keys[parent] <= key:
            break
        heap_keys[i], heap_cells[i] = heap_keys[parent], heap_cells[parent]
        i = parent
    heap_keys[i], heap_cells[i] = key, cell


@njit(cache=True, nogil=True)
def _pop(heap_keys, heap_cells, size):
    """Remove the first entry of a heap of this size; the caller has read it."""
    last = size - 1
    key, cell = heap_keys[last], heap_cells[last]
    i = 0
    while True:
        child = 2 * i + 1
        if child >= last:
            break
        if child + 1 < last and heap_keys[child + 1] < heap_keys[child]:
            child += 1
        if heap_keys[child] >= key:
            break
        heap_keys[i], heap_cells[i] = heap_keys[child], heap_cells[child]
        i = child
    heap_keys[i], heap_cells[i] = key, cell


@njit(cache=True, nogil=True)
def astar(costs, start_row, start_column, targets):
    """The cheapest way from a cell to any target cell.

    Args:
        costs: Factor of every cell, at least 1 where open, 0 where closed.
        start_row: Of an open cell.
        start_column: Of an open cell.
        targets: True at the cells to reach.

    Returns:
        Cells ``[row, column]`` from start to target, and the cost in cells; an empty path and
        infinity if there is no way.
    """
    rows, columns = costs.shape
    low_row, high_row, low_column, high_column = rows, -1, columns, -1
    for row in range(rows):
        for column in range(columns):
            if targets[row, column]:
                low_row, high_row = min(low_row, row), max(high_row, row)
                low_column, high_column = min(low_column, column), max(high_column, column)
    empty = np.empty((0, 2), dtype=np.int64)
    if high_row < 0:
        return empty, np.inf
    n = rows * columns
    best = np.full(n, np.inf)
    parent = np.full(n, -1, dtype=np.int64)
    done = np.zeros(n, dtype=np.bool_)
    capacity = 4096
    heap_keys = np.empty(capacity)
    heap_cells = np.empty(capacity, dtype=np.int64)
    start = start_row * columns + start_column
    best[start] = 0.0
    heap_keys[0], heap_cells[0] = 0.0, start
    size = 1
    while size > 0:
        cell = heap_cells[0]
        _pop(heap_keys, heap_cells, size)
        size -= 1
        if done[cell]:
            continue
        done[cell] = True
        row, column = cell // columns, cell % columns
        if targets[row, column]:
            return _way_back(parent, cell, columns), best[cell]
        for dr in range(-1, 2):
            for dc in range(-1, 2):
                r, c = row + dr, column + dc
                if (dr == 0 and dc == 0) or r < 0 or c < 0 or r >= rows or c >= columns:
                    continue
                if costs[r, c] <= 0.0:
                    continue
                diagonal = dr != 0 and dc != 0
                if diagonal and (costs[row, c] <= 0.0 or costs[r, column] <= 0.0):
                    continue
                step = (_SQRT2 if diagonal else 1.0) * 0.5 * (costs[row, column] + costs[r, c])
                g = best[cell] + step
                neighbour = r * columns + c
                if g >= best[neighbour]:
                    continue
                best[neighbour] = g
                parent[neighbour] = cell
                # Octile distance to the box around the targets: never too long, so A* is exact.
                ar = max(low_row - r, 0, r - high_row)
                ac = max(low_column - c, 0, c - high_column)
                h = max(ar, ac) + (_SQRT2 - 1.0) * min(ar, ac)
                if size == capacity:
                    capacity *= 2
                    keys = np.empty(capacity)
                    cells = np.empty(capacity, dtype=np.int64)
                    keys[:size] = heap_keys
                    cells[:size] = heap_cells
                    heap_keys, heap_cells = keys, cells
                _push(heap_keys, heap_cells, size, g + h, neighbour)
                size += 1
    return empty, np.inf


@njit(cache=True, nogil=True)
def _way_back(parent, cell, columns):
    length = 0
    at = cell
    while at >= 0:
        length += 1
        at = parent[at]
    path = np.empty((length, 2), dtype=np.int64)
    at = cell
    for i in range(length - 1, -1, -1):
        path[i, 0], path[i, 1] = at // columns, at % columns
        at = parent[at]
    return path


@njit(cache=True, nogil=True)
def dearest_on_line(costs, row_a, column_a, row_b, column_b):
    """The highest cost among all cells that a straight line touches; infinite if one is closed.

    Args:
        costs: As for `astar`.
        row_a: In cells, continuous: cell 0 spans 0 to 1.
        column_a: In cells, continuous.
        row_b: In cells, continuous.
        column_b: In cells, continuous.
    """
    rows, columns = costs.shape
    r, c = math.floor(row_a), math.floor(column_a)
    end_r, end_c = math.floor(row_b), math.floor(column_b)
    dr, dc = row_b - row_a, column_b - column_a
    step_r, step_c = (1 if dr > 0 else -1), (1 if dc > 0 else -1)
    t_r = ((r + (step_r > 0)) - row_a) / dr if dr != 0.0 else np.inf
    t_c = ((c + (step_c > 0)) - column_a) / dc if dc != 0.0 else np.inf
    per_r = abs(1.0 / dr) if dr != 0.0 else np.inf
    per_c = abs(1.0 / dc) if dc != 0.0 else np.inf
    dearest = 0.0
    for _ in range(abs(end_r - r) + abs(end_c - c) + 2):
        if r < 0 or c < 0 or r >= rows or c >= columns or costs[r, c] <= 0.0:
            return np.inf
        dearest = max(dearest, costs[r, c])
        if r == end_r and c == end_c:
            break
        if abs(t_r - t_c) < 1e-9:
            # Through a corner: both neighbours must be open.
            for rr, cc in ((r + step_r, c), (r, c + step_c)):
                if rr < 0 or cc < 0 or rr >= rows or cc >= columns or costs[rr, cc] <= 0.0:
                    return np.inf
            r, c = r + step_r, c + step_c
            t_r, t_c = t_r + per_r, t_c + per_c
        elif t_r < t_c:
            r, t_r = r + step_r, t_r + per_r
        else:
            c, t_c = c + step_c, t_c + per_c
    return dearest


@njit(cache=True, nogil=True)
def pull_string(costs, path):
    """Straighten a path: drop cells where the direct line is open and no dearer.

    Args:
        costs: As for `astar`.
        path: Cells ``[row, column]``.

    Returns:
        Places of the kept cells in the path, first and last included.
    """
    n = len(path)
    kept = np.empty(n, dtype=np.int64)
    kept[0] = 0
    count, anchor = 1, 0
    while anchor < n - 1:
        reach, dearest_between = anchor + 1, 0.0
        for i in range(anchor + 1, n):
            dearest_between = max(dearest_between, costs[path[i, 0], path[i, 1]])
            line = dearest_on_line(
                costs,
                path[anchor, 0] + 0.5,
                path[anchor, 1] + 0.5,
                path[i, 0] + 0.5,
                path[i, 1] + 0.5,
            )
            if line <= max(dearest_between, costs[path[anchor, 0], path[anchor, 1]]):
                reach = i
        kept[count] = reach
        count += 1
        anchor = reach
    return kept[:count]


@njit(cache=True, nogil=True)
def ways_to_go(costs, ends, knots, to_go):
    """How far it still is from each of several points, over a path that starts nearby.

    Args:
        costs: As for `astar`.
        ends: Points ``[row, column]``, continuous cells.
        knots: Points of the path, continuous cells.
        to_go: Length of the path from every knot to its end, cells.

    Returns:
        For each end the shortest straight line to a visible knot and the path from there on;
        infinite if no knot is visible.
    """
    result = np.full(len(ends), np.inf)
    for i in range(len(ends)):
        for j in range(len(knots)):
            dr, dc = knots[j, 0] - ends[i, 0], knots[j, 1] - ends[i, 1]
            way = math.sqrt(dr * dr + dc * dc) + to_go[j]
            if (
                way < result[i]
                and dearest_on_line(costs, ends[i, 0], ends[i, 1], knots[j, 0], knots[j, 1])
                < np.inf
            ):
                result[i] = way
    return result
