"""Gaps that are just too narrow: a robot looks at them from near before it gives a way up."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from hypernav.core.geometry.grid import has_cell
from hypernav.mapping.inflation import disc
from hypernav.planning.astar import astar
from hypernav.planning.costmap import Costmap

HOPE_M = 0.04
"""Error of a map that may close a gap seen from afar, on each of its sides, metres."""
_PRICE = np.float32(10.0)
"""Cost factor of a cell that may turn out to be closed; it stands for the way back then."""
_SAME_GAP_M = 0.5
"""Radius, metres, around a gap that was looked at, within which all gaps count as closed."""


@dataclass(frozen=True)
class Gap:
    """A gap that the map shows as just too narrow.

    Attributes:
        position: First position on the way where the robot does not fit, ``(x, y)``, metres.
        look_from: Last position before it where the robot fits, ``(x, y)``, metres.
    """

    position: tuple[float, float]
    look_from: tuple[float, float]


def gap_on_the_way(
    tight: Costmap,
    hopeful: Costmap,
    start: tuple[float, float],
    targets: Float64[np.ndarray, "n 2"],
    closed: tuple[tuple[float, float], ...],
) -> Gap | None:
    """The first gap on the cheapest way to a destination, if gaps may be wider than they look.

    Args:
        tight: Costmap with the smallest clearance that the robot accepts.
        hopeful: Costmap of the same map with obstacles inflated less, by `HOPE_M`.
        start: Position of the robot ``(x, y)``, metres.
        targets: Points ``(x, y)`` of the destination, metres.
        closed: Positions ``(x, y)``, metres, of gaps that were looked at, and are closed.

    Returns:
        None if there is no such way, if no gap is on it, or if the robot stands in one.
    """
    grid, costs = tight.grid, hopeful.costs.copy()
    doubtful = (tight.costs == 0.0) & (costs > 0.0)
    costs[doubtful] = _PRICE
    known_closed = np.zeros(costs.shape, dtype=bool)
    around = np.argwhere(disc(_SAME_GAP_M, grid.resolution_m))
    for position in closed:
        cells = around - around.max(axis=0) // 2 + np.array(grid.cell_of(*position))
        cells = cells[has_cell(costs.shape, cells[:, 0], cells[:, 1])]
        known_closed[cells[:, 0], cells[:, 1]] = True
    costs[doubtful & known_closed] = 0.0
    if tight.escape is None:
        return None
    wanted = grid.mask_of(targets) & (costs > 0.0)
    path, _ = astar(costs, grid.cell_of(*start), wanted.view(np.uint8))
    in_doubt = np.flatnonzero(doubtful[path[:, 0], path[:, 1]])
    if len(in_doubt) == 0 or in_doubt[0] == 0:  # at 0 the robot stands in it
        return None
    first = int(in_doubt[0])
    (x, y), (from_x, from_y) = grid.centres_of(path[[first, first - 1]]).tolist()
    return Gap((x, y), (from_x, from_y))
