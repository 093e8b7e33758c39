"""How far every cell is from the robot (numba kernel)."""

import numpy as np
from numba import njit

_STRAIGHT = 10
_DIAGONAL = 14
_BUCKETS = 16
FARTHEST = np.iinfo(np.int32).max
"""Marks cells that cannot be reached."""


@njit(cache=True, nogil=True)
def travel_tenths(is_open, start_row, start_column):
    """Length of the shortest 8-connected way from a cell to every other, in tenths of a cell.

    Dial's algorithm: Dijkstra with one list per distance, since steps cost 10 or 14. Ways never
    cut the corner of a closed cell.

    Args:
        is_open: True where the robot may be.
        start_row: Of an open cell.
        start_column: Of an open cell.

    Returns:
        int32, `FARTHEST` where no way leads.
    """
    rows, columns = is_open.shape
    distance = np.full((rows, columns), FARTHEST, dtype=np.int32)
    capacity = 8 * rows * columns + 1
    entry_cell = np.empty(capacity, dtype=np.int32)
    entry_next = np.empty(capacity, dtype=np.int32)
    heads = np.full(_BUCKETS, -1, dtype=np.int32)
    distance[start_row, start_column] = 0
    entry_cell[0], entry_next[0], heads[0] = start_row * columns + start_column, -1, 0
    used, waiting, level = 1, 1, 0
    while waiting > 0:
        bucket = level % _BUCKETS
        while heads[bucket] >= 0:
            entry = heads[bucket]
            heads[bucket] = entry_next[entry]
            waiting -= 1
            row, column = entry_cell[entry] // columns, entry_cell[entry] % columns
            if distance[row, column] != level:
                continue
            for dr in range(-1, 2):
                for dc in range(-1, 2):
                    r, c = row + dr, column + dc
                    if (dr == 0 and dc == 0) or r < 0 or c < 0 or r >= rows or c >= columns:
                        continue
                    if not is_open[r, c]:
                        continue
                    diagonal = dr != 0 and dc != 0
                    if diagonal and not (is_open[row, c] and is_open[r, column]):
                        continue
                    way = level + (_DIAGONAL if diagonal else _STRAIGHT)
                    if way < distance[r, c]:
                        distance[r, c] = way
                        entry_cell[used] = r * columns + c
                        entry_next[used] = heads[way % _BUCKETS]
                        heads[way % _BUCKETS] = used
                        used += 1
                        waiting += 1
        level += 1
    return distance
