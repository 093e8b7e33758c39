"""The costmap: obstacles inflated, narrow and unknown cells dearer."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, UInt8

from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.mapping.escape import Escape
from hypernav.mapping.inflation import inflate
from hypernav.planning.config import PlanningConfig

_MARGIN_M = 1.0
"""Distance beyond the explored part that a path may lead."""
_ESCAPE_COST = np.float32(3.0)
"""Cost factor of an escape from an inflated obstacle: the robot may scrape along it."""


@dataclass(frozen=True, eq=False)
class Costmap:
    """The explored part of the map with the cost of every cell.

    Attributes:
        grid: Cropped map.
        costs: Factor on the length of a path through a cell; 0 where the robot cannot be.
        is_open: Mask of the cells where the robot may stay: 1 where the cost is not 0 and the cell
            is no part of the escape.
        escape: Path from the robot to open floor, whose cells have costs too; None if there is
            none.
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
    ) -> "Costmap":
        """Inflate the obstacles of a map and give the other cells their costs.

        Args:
            grid: The map.
            config: Cost factors.
            robot: Position of the robot ``(x, y)``, metres. Inside an inflated obstacle, the cells
                of an escape get a cost.
            clearance_m: Distance from obstacles that the robot's middle keeps, metres.
            is_squeezed: Whether that distance is less than it should be.
        """
        grid = grid.cropped(_MARGIN_M)
        size = grid.resolution_m
        occupied = grid.cells == Cell.OCCUPIED
        closed = inflate(occupied, clearance_m, size)
        # One cost for every state of a cell, away from obstacles and near them.
        prices = np.array([config.unknown_cost, 1.0, 1.0], dtype=np.float32)
        prices = np.concatenate([prices, prices * np.float32(1.0 + config.comfort_cost)])
        kind = grid.cells
        if config.comfort_cost > 0.0 and config.comfort_m > 0.0:
            kind = kind + np.uint8(3) * inflate(closed, config.comfort_m, size)
        costs = np.take(prices, kind)
        costs[closed > 0] = 0.0
        is_open = (costs > 0.0).view(np.uint8)
        here = grid.cell_of(*robot)
        if config.start_in_obstacle == "nearest":
            escape = Escape.straight(is_open, grid.free, here)
        else:
            escape = Escape.find(occupied, is_open, here, size)
        if escape is not None:
            costs[escape.cells & (is_open == 0)] = _ESCAPE_COST
        return Costmap(grid, costs, is_open, escape, clearance_m, is_squeezed)

    @property
    def is_tight(self) -> bool:
        """Whether steps of full length may not fit around the robot."""
        return self.is_squeezed or self.escape is None or bool(self.escape.cells.any())

    def continuous(self, x: float, y: float) -> tuple[float, float]:
        """A point in continuous ``(row, column)`` cells."""
        origin, size = self.grid.origin, self.grid.resolution_m
        return ((y - origin[1]) / size, (x - origin[0]) / size)
