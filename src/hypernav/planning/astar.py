"""A* search over a costmap."""

import numpy as np
from jaxtyping import Float32, Int64, UInt8

from hypernav.planning.astar_kernels import expand, path_back


def astar(
    costs: Float32[np.ndarray, "rows columns"],
    start: tuple[int, int],
    targets: UInt8[np.ndarray, "rows columns"],
) -> tuple[Int64[np.ndarray, "n 2"], float]:
    """The cheapest path from a cell to any target cell.

    Args:
        costs: Factor on the length of a path through a cell, at least 1; 0 where closed.
        start: Open cell ``(row, column)`` to start from.
        targets: Mask of the cells to reach: not 0 there.

    Returns:
        Cells ``[row, column]`` from start to target, and the cost, in cells of cost 1; no cells and
        infinity if there is no path.
    """
    rows = np.flatnonzero(targets.max(axis=1))
    columns = np.flatnonzero(targets.max(axis=0))
    if rows.size == 0:
        return np.zeros((0, 2), dtype=np.int64), np.inf
    box = (int(rows[0]), int(rows[-1]), int(columns[0]), int(columns[-1]))
    spent, came_from, found = expand(costs, *start, targets, box, 0.0)
    if found < 0:
        return np.zeros((0, 2), dtype=np.int64), np.inf
    return path_back(came_from, found, costs.shape[1] + 2), float(spent[found])


def costs_to_go(
    costs: Float32[np.ndarray, "rows columns"],
    end: tuple[int, int],
    robot: tuple[int, int],
    slack: float,
) -> Float32[np.ndarray, "rows columns"]:
    """Costs of the cheapest paths to a cell from the cells around the robot.

    Args:
        costs: Costs of cells, as for `astar`.
        end: Open cell ``(row, column)`` to go to.
        robot: Cell ``(row, column)`` of the robot, whose surroundings matter.
        slack: Cost beyond that of the robot's path up to which paths are searched, in cells.

    Returns:
        Cost in cells; infinite where there is no path, and for most of what is farther away.
    """
    rows, columns = costs.shape
    targets = np.zeros(costs.shape, dtype=np.uint8)
    targets[robot] = 1
    spent, _, _ = expand(costs, *end, targets, (0, rows - 1, 0, columns - 1), slack)
    return np.ascontiguousarray(spent.reshape(rows + 2, columns + 2)[1:-1, 1:-1])
