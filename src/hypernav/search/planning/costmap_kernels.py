"""Cheapest paths over a grid of costs, and sequences of actions over it, compiled.

A step is long compared with the width of a door, and headings are few: whether steps fit through
a door is decided some steps before it. So whole sequences of actions are searched.

A cell's cost is the factor on the length of a path through it; 0 means closed. Paths over cells are
8-connected and cut no corners. Other positions are in continuous cells ``(row, column)``: cell 0
spans 0 to 1, its middle is 0.5.
"""

import math

import numpy as np
from numba import njit
from numba.extending import register_jitable

from hypernav.search.mapping.grid_kernels import SQRT2

BUCKETS_PER_CELL = 2
"""Number of buckets per cell of cost; with more, fewer cells are visited twice."""

SLACK = 1.0
"""Cost by which a line may exceed the path that it replaces, cells, to allow for rounding."""
GO, LEFT, RIGHT = 0, 1, 2
MOST_NODES = 8000
"""Bound on the nodes of a search for actions; only hopeless searches come near it."""
DETOUR_COST = 0.2
"""Weight of the cost of a sequence that does not lead as far as it should."""


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


@njit(cache=True, nogil=True)
def priced(unknown, closed, near, unknown_cost, near_factor):
    """Costs of all cells: 0 where closed, more for the unknown and near obstacles.

    Args:
        unknown: bool (rows, columns), the unexplored cells.
        closed: uint8 (rows, columns), not 0 where the robot cannot be.
        near: uint8 (rows, columns), not 0 near obstacles.
        unknown_cost: float32, cost of an unexplored cell away from obstacles; of others it is 1.
        near_factor: float32, factor on the cost of either kind near obstacles.

    Returns:
        float32 (rows, columns), the costs.
    """
    rows, columns = closed.shape
    costs = np.empty((rows, columns), dtype=np.float32)
    # Without a table and without branches the compiler works on many cells at a time.
    unknown_near = unknown_cost * near_factor
    for row in range(rows):
        for column in range(columns):
            is_near = near[row, column] != 0
            if unknown[row, column]:
                cost = unknown_near if is_near else unknown_cost
            else:
                cost = near_factor if is_near else np.float32(1.0)
            costs[row, column] = np.float32(0.0) if closed[row, column] != 0 else cost
    return costs


@njit(cache=True, nogil=True)
def cost_of_line(costs, row_a, column_a, row_b, column_b):
    """Cost of the line between two positions, in cells; infinite if it touches a closed cell.

    A line that passes exactly through a corner touches all four cells there.

    Args:
        costs: Costs, float32 (rows, columns), as for `astar`.
        row_a: Row of the first position.
        column_a: Column of the first position.
        row_b: Row of the second position.
        column_b: Column of the second position.
    """
    rows, columns = costs.shape
    r, c = math.floor(row_a), math.floor(column_a)
    end_r, end_c = math.floor(row_b), math.floor(column_b)
    dr, dc = row_b - row_a, column_b - column_a
    length = math.sqrt(dr * dr + dc * dc)
    step_r, step_c = (1 if dr > 0.0 else -1), (1 if dc > 0.0 else -1)
    # Where along the line, from 0 to 1, the next row and the next column begin.
    next_r = ((r + (step_r > 0)) - row_a) / dr if dr != 0.0 else np.inf
    next_c = ((c + (step_c > 0)) - column_a) / dc if dc != 0.0 else np.inf
    per_r = abs(1.0 / dr) if dr != 0.0 else np.inf
    per_c = abs(1.0 / dc) if dc != 0.0 else np.inf
    total, along = 0.0, 0.0
    for _ in range(abs(end_r - r) + abs(end_c - c) + 1):
        if r < 0 or c < 0 or r >= rows or c >= columns or costs[r, c] <= 0.0:
            return np.inf
        leave = min(next_r, next_c, 1.0)
        total += (leave - along) * length * costs[r, c]
        along = leave
        if r == end_r and c == end_c:
            break
        if abs(next_r - next_c) < 1e-9:
            for rr, cc in ((r + step_r, c), (r, c + step_c)):
                if rr < 0 or cc < 0 or rr >= rows or cc >= columns or costs[rr, cc] <= 0.0:
                    return np.inf
            r, c = r + step_r, c + step_c
            next_r, next_c = next_r + per_r, next_c + per_c
        elif next_r < next_c:
            r, next_r = r + step_r, next_r + per_r
        else:
            c, next_c = c + step_c, next_c + per_c
    return total


@njit(cache=True, nogil=True)
def shortcut(costs, path, start_row, start_column):
    """Straighten a path: drop cells where the direct line is open and costs hardly more.

    Args:
        costs: Costs, as for `cost_of_line`.
        path: int64 (n, 2), cells ``[row, column]``.
        start_row: Continuous row of the start, in the path's first cell.
        start_column: Continuous column of the start.

    Returns:
        int64 (kept,), indices of the kept cells in the path, first and last included.
    """
    n = len(path)
    kept = np.empty(n, dtype=np.int64)
    kept[0] = 0
    count, anchor = 1, 0
    row, column = start_row, start_column
    while anchor < n - 1:
        reach, spent = anchor + 1, 0.0
        for i in range(anchor + 1, n):
            r, c, before_r, before_c = path[i, 0], path[i, 1], path[i - 1, 0], path[i - 1, 1]
            step = math.sqrt((r - before_r) ** 2 + (c - before_c) ** 2)
            spent += step * 0.5 * (costs[r, c] + costs[before_r, before_c])
            if cost_of_line(costs, row, column, r + 0.5, c + 0.5) <= spent + SLACK:
                reach = i
        kept[count] = reach
        count += 1
        anchor = reach
        row, column = path[anchor, 0] + 0.5, path[anchor, 1] + 0.5
    return kept[:count]


@register_jitable(no_cfunc_wrapper=True)
def push(keys, nodes, size, key, node):
    """Put a node into a heap that holds ``size`` nodes, the smallest key first, in place."""
    i = size
    while i > 0 and keys[(i - 1) // 2] > key:
        keys[i], nodes[i] = keys[(i - 1) // 2], nodes[(i - 1) // 2]
        i = (i - 1) // 2
    keys[i], nodes[i] = key, node


@register_jitable(no_cfunc_wrapper=True)
def drop_first(keys, nodes, size):
    """Take the first node out of a heap that holds ``size`` nodes, in place."""
    key, node = keys[size - 1], nodes[size - 1]
    i = 0
    while 2 * i + 1 < size - 1:
        child = 2 * i + 1
        if child + 1 < size - 1 and keys[child + 1] < keys[child]:
            child += 1
        if keys[child] >= key:
            break
        keys[i], nodes[i] = keys[child], nodes[child]
        i = child
    keys[i], nodes[i] = key, node


@njit(cache=True, nogil=True)
def plan_actions(costs, to_go, row, column, sines, cosines, step, turn_cost, arrive, horizon):
    """The best sequence of turns and steps, as far as a horizon.

    A* over positions and headings, guided by the cost that is left to go. No step touches a closed
    cell.

    Args:
        costs: float32 (rows, columns), 0 where closed.
        to_go: float32 (rows, columns), cost from each cell to the end, cells; infinite if unknown.
        row: Row of the robot, continuous.
        column: Column of the robot, continuous.
        sines: float64 (turns,), sines of all headings, the present one first, then to the left.
        cosines: float64 (turns,), cosines of the same headings.
        step: Length of a step, cells.
        turn_cost: Cost of a turn, cells.
        arrive: Cost left to go at which the search ends, cells.
        horizon: Reduction of the cost left to go at which the search ends, cells.

    Returns:
        int64 (n,) of `GO`, `LEFT` and `RIGHT`, and the cost left to go after them. If the search
        ends before, those of the least cost to go plus `DETOUR_COST` times their own; maybe none.
    """
    turns = len(sines)
    reach = int(horizon + 4.0 * step)
    done = np.zeros((2 * reach + 1, 2 * reach + 1, turns), dtype=np.uint8)
    positions = np.empty((MOST_NODES, 2))
    headings = np.empty(MOST_NODES, dtype=np.int64)
    spent = np.empty(MOST_NODES)
    parents = np.empty(MOST_NODES, dtype=np.int64)
    actions = np.empty(MOST_NODES, dtype=np.int64)
    keys = np.empty(MOST_NODES)
    nodes = np.empty(MOST_NODES, dtype=np.int64)

    first_row, first_column = math.floor(row), math.floor(column)
    start = to_go[first_row, first_column]
    goal = max(arrive, start - horizon)
    positions[0, 0], positions[0, 1], headings[0], spent[0], parents[0] = row, column, 0, 0.0, -1
    keys[0], nodes[0] = start, 0
    used, size, best, best_value = 1, 1, 0, start
    while size > 0 and used + 3 <= MOST_NODES:
        node = nodes[0]
        drop_first(keys, nodes, size)
        size -= 1
        y, x, heading = positions[node, 0], positions[node, 1], headings[node]
        r, c = math.floor(y), math.floor(x)
        i, j = r - first_row + reach, c - first_column + reach
        if i < 0 or j < 0 or i > 2 * reach or j > 2 * reach or done[i, j, heading] > 0:
            continue
        done[i, j, heading] = 1
        if to_go[r, c] <= goal:
            best = node
            break
        value = to_go[r, c] + DETOUR_COST * spent[node]
        if value < best_value:
            best, best_value = node, value
        for action in range(3):
            if action == GO:
                end_y, end_x = y + step * sines[heading], x + step * cosines[heading]
                cost = cost_of_line(costs, y, x, end_y, end_x)
                new = heading
            else:
                end_y, end_x, cost = y, x, turn_cost
                new = (heading + (1 if action == LEFT else turns - 1)) % turns
            if np.isinf(cost):
                continue
            left = to_go[math.floor(end_y), math.floor(end_x)]
            if np.isinf(left):
                continue
            positions[used, 0], positions[used, 1], headings[used] = end_y, end_x, new
            spent[used], parents[used], actions[used] = spent[node] + cost, node, action
            push(keys, nodes, size, spent[used] + left, used)
            size += 1
            used += 1
    length, at = 0, best
    while parents[at] >= 0:
        length += 1
        at = parents[at]
    sequence = np.empty(length, dtype=np.int64)
    at = best
    for k in range(length - 1, -1, -1):
        sequence[k] = actions[at]
        at = parents[at]
    return sequence, to_go[math.floor(positions[best, 0]), math.floor(positions[best, 1])]
