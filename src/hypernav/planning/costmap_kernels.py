"""Costs of cells, compiled."""

import numpy as np
from numba import njit


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
