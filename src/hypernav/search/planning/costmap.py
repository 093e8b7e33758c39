"""The costmap: obstacles are inflated; cells near them and unknown cells cost more."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, UInt8

from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.search.mapping.inflation import Escape, inflate
from hypernav.search.planning.config import PlanningConfig
from hypernav.search.planning.costmap_kernels import priced

_MARGIN_M = 1.0
"""Distance beyond the explored part up to which a path may lead, metres."""
_COMFORT_M = 0.2
"""Distance beyond the dilation within which a path costs more, metres, so that it keeps to the
middle of doors where there is room."""
_ESCAPE_COST = np.float32(3.0)
"""Cost factor of an escape from an inflated obstacle: the robot may scrape along it."""
HORIZON_M = 3.0
"""Length of path over which actions are searched, metres: beyond the next door, and bend."""
SIDEWAYS_M = 1.0
"""Length, metres, by which paths to the aim may exceed the robot's and still be searched."""
LOOK_AHEAD_M = HORIZON_M + SIDEWAYS_M
"""Length of path to the point that the actions aim at, metres."""
SURROUNDINGS_M = LOOK_AHEAD_M + SIDEWAYS_M
"""Distance around the given points, metres, within which all costs are computed."""
LEAST_GAIN_M = 0.05
"""Smallest reduction of the cost left to go, metres, that makes actions worth taking."""


@dataclass(frozen=True, eq=False)
class Costmap:
    """The explored part of the map with the cost of every cell.

    Attributes:
        grid: Cropped map.
        costs: Factor on the length of a path through a cell; 0 where the cell is closed.
        is_open: Mask of the cells where the robot may stay: 1 where the cost is not 0 and the cell
            is no part of the escape.
        escape: Path from the robot to the nearest open cell, whose cells have costs too; None if
            there is none.
        clearance_m: Distance from obstacles that the robot's middle keeps, metres.
        is_squeezed: Whether that distance is less than it should be.
    """

    grid: OccupancyGrid
    costs: Float32[np.ndarray, "rows columns"]
    is_open: UInt8[np.ndarray, "rows columns"]
    escape: Escape | None
    clearance_m: float
    is_squeezed: bool

    @staticmethod
    def of(
        grid: OccupancyGrid,
        config: PlanningConfig,
        robot: tuple[float, float],
        clearance_m: float,
        *,
        is_squeezed: bool = False,
        around: Sequence[tuple[float, float]] = (),
    ) -> "Costmap":
        """Inflate the obstacles of a map and give the other cells their costs.

        Args:
            grid: The map.
            config: Cost factors.
            robot: Position of the robot ``(x, y)``, metres. Inside an inflated obstacle, the cells
                of an escape get a cost.
            clearance_m: Distance from obstacles that the robot's middle keeps, metres.
            is_squeezed: Whether that distance is less than it should be.
            around: Points ``(x, y)``, metres; what is farther than `SURROUNDINGS_M` from the box
                around them may count as closed, so that the time taken does not grow with the map.
                Without any, the whole map is priced.
        """
        grid = grid.cropped(_MARGIN_M)
        size = grid.resolution_m
        margin_m = SURROUNDINGS_M + clearance_m + _COMFORT_M
        # The free cell nearest to the robot may lie anywhere on the map.
        is_whole = config.start_in_obstacle == "nearest"
        window = _window(grid, () if is_whole else around, margin_m)
        occupied = np.zeros(grid.cells.shape, dtype=bool)
        occupied[window] = grid.cells[window] == Cell.OCCUPIED
        closed = inflate(occupied[window], clearance_m, size)
        near = closed
        if config.comfort_cost > 0.0:
            near = inflate(closed, _COMFORT_M, size)
        costs = np.zeros(grid.cells.shape, dtype=np.float32)
        costs[window] = priced(
            grid.cells[window] == Cell.UNKNOWN,
            closed,
            near,
            np.float32(config.unknown_cost),
            np.float32(1.0 + config.comfort_cost),
        )
        is_open = (costs > 0.0).view(np.uint8)
        here = grid.cell_of(*robot)
        if config.start_in_obstacle == "nearest":
            escape = Escape.straight(is_open, grid.free, here)
        else:
            escape = Escape.find(occupied, is_open, here, size)
        if escape is not None and escape.cells.any():
            costs[escape.cells & (is_open == 0)] = _ESCAPE_COST
        return Costmap(grid, costs, is_open, escape, clearance_m, is_squeezed)

    @property
    def is_tight(self) -> bool:
        """Whether steps of full length may not fit around the robot."""
        return self.is_squeezed or self.escape is None or bool(self.escape.cells.any())

    def continuous(self, x: float, y: float) -> tuple[float, float]:
        """A point ``(x, y)``, ``map`` frame, metres, as continuous ``(row, column)``, cells."""
        origin, size = self.grid.origin, self.grid.resolution_m
        return ((y - origin[1]) / size, (x - origin[0]) / size)


def _window(
    grid: OccupancyGrid, points: Sequence[tuple[float, float]], margin_m: float
) -> tuple[slice, slice]:
    """Rows and columns of the box around some points, with a margin; all if there are none."""
    if not points:
        return (slice(None), slice(None))
    margin = math.ceil(margin_m / grid.resolution_m)
    cells = grid.cells_of(np.array(points))
    # A robot off the map counts as standing on the nearest cell of its edge.
    first = np.clip(cells.min(axis=0) - margin, 0, np.array(grid.cells.shape) - 1)
    last = np.maximum(cells.max(axis=0) + margin, first)
    return (slice(first[0], last[0] + 1), slice(first[1], last[1] + 1))
