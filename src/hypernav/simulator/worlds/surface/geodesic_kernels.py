"""Lines of sight and any-angle shortest paths on a grid of free and blocked cells (numba kernels).

The free space is the union of the closed free cells; a path may touch blocked cells and run along
them, but not pass between two that touch only at a corner. A shortest path bends only at corners
of blocked cells, and these are vertices of the lattice. So Dijkstra's algorithm runs over the
lattice, and every vertex stores its *root*: the target or bend from which it is visible in a
straight line (the idea of Theta*, Nash et al. 2007, with roots only at true bends).

Coordinates are integers in units of 1 / `UNITS` of a cell, so that lines of sight are exact.
Roots are numbered: first the targets, then the vertices.
"""

import numpy as np
from numba import njit
from numba.extending import register_jitable

UNITS = 1024
CLOSED, OPEN, CORNER = 0, 1, 2
_REACH = 4
"""A bend or target is offered as a root to all vertices within this many cells, not only to the
next ones, because the region of which it is the root may begin in a gap between vertices."""


@register_jitable(no_cfunc_wrapper=True)
def _doubled(array):
    longer = np.empty(array.size * 2, dtype=array.dtype)
    for k in range(array.size):
        longer[k] = array[k]
    return longer


@register_jitable(no_cfunc_wrapper=True)
def push(keys, items, size, key, item):
    """Add to a binary heap; returns its arrays, which may be new ones."""
    if size == keys.size:
        keys, items = _doubled(keys), _doubled(items)
    k = size
    while k > 0:
        parent = (k - 1) >> 1
        if keys[parent] <= key:
            break
        keys[k], items[k] = keys[parent], items[parent]
        k = parent
    keys[k], items[k] = key, item
    return keys, items


@register_jitable(no_cfunc_wrapper=True)
def pop(keys, items, size):
    """Remove the smallest; the caller reads entry 0 before and decreases `size` itself."""
    key, item = keys[size - 1], items[size - 1]
    size -= 1
    k = 0
    while True:
        child = 2 * k + 1
        if child >= size:
            break
        if child + 1 < size and keys[child + 1] < keys[child]:
            child += 1
        if keys[child] >= key:
            break
        keys[k], items[k] = keys[child], items[child]
        k = child
    if size > 0:
        keys[k], items[k] = key, item


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


@njit(cache=True, nogil=True)
def vertex_kinds(free):
    """What every vertex is: `CLOSED`, `OPEN` or `CORNER`; `free` has a blocked border.

    A vertex is closed if no cell at it is free, or only two that lie diagonally. It is a corner,
    where a path may bend, if just one cell at it is blocked.
    """
    rows, columns = free.shape
    kinds = np.zeros((rows + 1, columns + 1), dtype=np.uint8)
    for i in range(1, rows):
        for j in range(1, columns):
            a, b, c, d = free[i - 1, j - 1], free[i - 1, j], free[i, j - 1], free[i, j]
            pinched = (a and d and not b and not c) or (b and c and not a and not d)
            if a + b + c + d == 3:
                kinds[i, j] = CORNER
            elif (a or b or c or d) and not pinched:
                kinds[i, j] = OPEN
    return kinds


@register_jitable(no_cfunc_wrapper=True)
def _root_position(root, targets, width):
    if root < targets.shape[0]:
        return targets[root, 0], targets[root, 1]
    vertex = root - targets.shape[0]
    return (vertex % width) * UNITS, (vertex // width) * UNITS


@register_jitable(no_cfunc_wrapper=True)
def _length(x0, y0, x1, y1):
    return np.sqrt(np.float64((x1 - x0) ** 2 + (y1 - y0) ** 2))


@register_jitable(no_cfunc_wrapper=True)
def _one_step(free, i, j, di, dj):
    """Whether one can walk from a vertex to the next one, along an edge or across a cell."""
    if di == 0:
        column = min(j, j + dj)
        return free[i - 1, column] or free[i, column]
    if dj == 0:
        row = min(i, i + di)
        return free[row, j - 1] or free[row, j]
    return free[min(i, i + di), min(j, j + dj)]


@register_jitable(no_cfunc_wrapper=True)
def _bend_between(free, kinds, best, root_x, root_y, via_x, via_y, x, y):
    """The last bend of a taut path from a root to a point that it doesn't see.

    The path leads through a position beside the point, visible from the root; pulled tight, it
    bends at corners inside the thin triangle of the three. The last one before the point is the
    corner farthest to the side of that position.

    Returns:
        The vertex, or -1 if there is none that the point sees.
    """
    height, width = kinds.shape
    found_i, found_j = -1, -1
    found_x, found_y = root_x - x, root_y - y
    # Cross products have the sign of this one on the side of the seen position.
    side = (root_x - x) * (via_y - y) - (root_y - y) * (via_x - x)
    if side == 0:
        return -1
    along_x = abs(x - root_x) >= abs(y - root_y)
    if along_x:
        low, high = min(root_x, x, via_x), max(root_x, x, via_x)
    else:
        low, high = min(root_y, y, via_y), max(root_y, y, via_y)
    for a in range(-(-low // UNITS), high // UNITS + 1):
        # Where the triangle's sides cross this lattice line.
        first, last = np.inf, -np.inf
        for k in range(3):
            if k == 0:
                x0, y0, x1, y1 = root_x, root_y, x, y
            elif k == 1:
                x0, y0, x1, y1 = root_x, root_y, via_x, via_y
            else:
                x0, y0, x1, y1 = via_x, via_y, x, y
            if not along_x:
                x0, y0, x1, y1 = y0, x0, y1, x1
            at = a * UNITS
            if min(x0, x1) <= at <= max(x0, x1):
                if x0 == x1:
                    first, last = min(first, y0, y1), max(last, y0, y1)
                else:
                    cross = y0 + (y1 - y0) * ((at - x0) / (x1 - x0))
                    first, last = min(first, cross), max(last, cross)
        if first > last:
            continue
        for b in range(int(np.ceil(first / UNITS - 1e-9)), int(np.floor(last / UNITS + 1e-9)) + 1):
            i, j = (b, a) if along_x else (a, b)
            if not (0 <= i < height and 0 <= j < width and kinds[i, j] == CORNER):
                continue
            if not np.isfinite(best[i * width + j]):
                continue
            to_x, to_y = j * UNITS - x, i * UNITS - y
            cross = found_x * to_y - found_y * to_x
            if (cross > 0) == (side > 0) and cross != 0:
                found_i, found_j, found_x, found_y = i, j, to_x, to_y
    if found_i < 0 or not line_of_sight(free, found_j * UNITS, found_i * UNITS, x, y):
        return -1
    return found_i * width + found_j


@njit(cache=True, nogil=True)
def propagate(free, kinds, targets, goal_x, goal_y):
    """Distance of every vertex to the nearest target, and its root.

    With a goal (`goal_x` not negative) the search is directed to it, as in A*, and ends when its
    distance is final; other vertices then have upper bounds.

    Args:
        free: Free cells, with a blocked border.
        kinds: From `vertex_kinds`.
        targets: Points ``(x, y)`` in free cells.
        goal_x: x of the goal in free space, or -1.
        goal_y: y of the goal in free space, or -1.

    Returns:
        Distances (units; infinite where no path leads) and roots (-1 there).
    """
    height, width = kinds.shape
    count = targets.shape[0]
    best = np.full(height * width, np.inf)
    root = np.full(height * width, -1, dtype=np.int32)
    keys = np.empty(1024, dtype=np.float64)
    items = np.empty(1024, dtype=np.int64)
    size = 0
    directed = goal_x >= 0
    bound = np.inf
    # First the targets are offered as roots, then the vertices in order of their distance.
    turn = 0
    while turn < count or size > 0:
        if turn < count:
            v = np.int64(-1)
            from_x, from_y = targets[turn, 0], targets[turn, 1]
            j, i = from_x // UNITS, from_y // UNITS
            own, reach, own_root = 0.0, _REACH, turn
            root_x, root_y, root_best = from_x, from_y, 0.0
            turn += 1
        else:
            key, v = keys[0], items[0]
            pop(keys, items, size)
            size -= 1
            i, j = v // width, v % width
            from_x, from_y = j * UNITS, i * UNITS
            own = best[v]
            to_goal = _length(from_x, from_y, goal_x, goal_y) if directed else 0.0
            # The vertices along the best path lie beside it, so their paths are a little longer.
            if key >= bound + 2 * UNITS:
                break
            if directed and 0 <= i - goal_y // UNITS <= 1 and 0 <= j - goal_x // UNITS <= 1:
                bound = min(bound, own + to_goal)  # A corner of the goal's cell always sees it.
            if key > own + to_goal + 1e-6:
                continue
            reach = _REACH if kinds[i, j] == CORNER else 1
            own_root = count + v
            root_x, root_y = _root_position(root[v], targets, width)
            root_best = own - _length(root_x, root_y, from_x, from_y)
        for ni in range(max(i - reach, 0), min(i + reach + 1, height)):
            for nj in range(max(j - reach, 0), min(j + reach + 1, width)):
                if kinds[ni, nj] == CLOSED:
                    continue
                n = ni * width + nj
                x, y = nj * UNITS, ni * UNITS
                new = root_best + _length(root_x, root_y, x, y)
                if new >= best[n] - 1e-3:
                    continue
                if v < 0 or abs(ni - i) > 1 or abs(nj - j) > 1:
                    new, new_root = own + _length(from_x, from_y, x, y), own_root
                    if new >= best[n] - 1e-3 or not line_of_sight(free, from_x, from_y, x, y):
                        continue
                elif line_of_sight(free, root_x, root_y, x, y):
                    new_root = root[v]
                else:
                    if not _one_step(free, i, j, ni - i, nj - j):
                        continue
                    bend = _bend_between(free, kinds, best, root_x, root_y, from_x, from_y, x, y)
                    if bend < 0:
                        bend = v
                    new_root = count + bend
                    bend_x, bend_y = _root_position(new_root, targets, width)
                    new = best[bend] + _length(bend_x, bend_y, x, y)
                    if new >= best[n] - 1e-3:
                        continue
                best[n], root[n] = new, new_root
                if directed:
                    new += _length(x, y, goal_x, goal_y)
                keys, items = push(keys, items, size, new, n)
                size += 1
    return best, root


@njit(cache=True, nogil=True)
def first_bend(free, kinds, targets, cell_start, best, root, x, y):
    """Distance from a point to the nearest target, and the first bend on the path.

    Args:
        free: As for `propagate`.
        kinds: As for `propagate`.
        targets: As for `propagate`, sorted by cell.
        cell_start: First target of every cell, and the number of targets at the end.
        best: Distances from `propagate`.
        root: Roots from `propagate`.
        x: x of the point, in a free cell.
        y: y of the point, in a free cell.

    Returns:
        Distance in units (infinite if no path leads to a target) and the next root on the path.
    """
    height, width = kinds.shape
    count = targets.shape[0]
    row, column = y // UNITS, x // UNITS
    shortest = np.inf
    towards = -1
    # A target may be so close that no vertex has it as its root.
    for i in range(max(row - 2, 0), min(row + 3, free.shape[0])):
        first = i * free.shape[1] + max(column - 2, 0)
        last = i * free.shape[1] + min(column + 2, free.shape[1] - 1)
        for t in range(cell_start[first], cell_start[last + 1]):
            d = _length(x, y, targets[t, 0], targets[t, 1])
            if d < shortest and line_of_sight(free, x, y, targets[t, 0], targets[t, 1]):
                shortest, towards = d, t
    for i in range(max(row - _REACH, 0), min(row + 2 + _REACH, height)):
        for j in range(max(column - _REACH, 0), min(column + 2 + _REACH, width)):
            v = i * width + j
            if root[v] < 0:
                continue
            at_x, at_y = j * UNITS, i * UNITS
            beside = 0 <= i - row <= 1 and 0 <= j - column <= 1
            if beside or kinds[i, j] == CORNER:
                d = best[v] + _length(at_x, at_y, x, y)
                if d < shortest and line_of_sight(free, at_x, at_y, x, y):
                    shortest, towards = d, count + v
            if not (-1 <= i - row <= 2 and -1 <= j - column <= 2):
                continue
            root_x, root_y = _root_position(root[v], targets, width)
            d = best[v] - _length(root_x, root_y, at_x, at_y) + _length(root_x, root_y, x, y)
            if d >= shortest:
                continue
            if line_of_sight(free, root_x, root_y, x, y):
                shortest, towards = d, root[v]
            elif beside:
                bend = _bend_between(free, kinds, best, root_x, root_y, at_x, at_y, x, y)
                if bend >= 0:
                    bend_x, bend_y = _root_position(count + bend, targets, width)
                    d = best[bend] + _length(bend_x, bend_y, x, y)
                    if d < shortest:
                        shortest, towards = d, count + bend
    return shortest, towards
