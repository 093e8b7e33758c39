"""What a way over the map costs: obstacles inflated, narrow and unknown places dearer."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, UInt8

from hypernav.core.grid import Cell, OccupancyGrid
from hypernav.mapping.distance_kernels import nearest_open_cell
from hypernav.mapping.inflation import inflate
from hypernav.planning.config import PlanningConfig

_MARGIN_M = 1.0
"""How far beyond the explored part a way may lead."""
_START_WITHIN_M = 1.0
"""How far away an open cell may be for a robot that stands inside an inflated obstacle."""


@dataclass(frozen=True, eq=False)
class Terrain:
    """The explored part of the map with the cost of every cell.

    Attributes:
        grid: The cropped map.
        costs: Factor on the length of a way through a cell; 0 where the robot cannot be.
        is_open: 1 where the cost is not 0.
    """

    grid: OccupancyGrid
    costs: Float32[np.ndarray, "rows columns"]
    is_open: UInt8[np.ndarray, "rows columns"]

    @staticmethod
    def of(grid: OccupancyGrid, config: PlanningConfig) -> "Terrain":
        """Inflate the obstacles of a map and price the rest."""
        grid = grid.cropped(_MARGIN_M)
        size = grid.resolution_m
        closed = inflate(grid.cells == Cell.OCCUPIED, config.inflation_m, size)
        # One price for every state of a cell, away from obstacles and near them.
        prices = np.array([config.unknown_cost, 1.0, 1.0], dtype=np.float32)
        prices = np.concatenate([prices, prices * np.float32(1.0 + config.comfort_cost)])
        kind = grid.cells
        if config.comfort_cost > 0.0 and config.comfort_m > 0.0:
            kind = kind + np.uint8(3) * inflate(closed, config.comfort_m, size)
        costs = np.take(prices, kind)
        costs[closed > 0] = 0.0
        return Terrain(grid, costs, (costs > 0.0).view(np.uint8))

    def continuous(self, x: float, y: float) -> tuple[float, float]:
        """A point in continuous ``(row, column)`` cells."""
        origin, size = self.grid.origin, self.grid.resolution_m
        return ((y - origin[1]) / size, (x - origin[0]) / size)

    def nearest_open(self, row: int, column: int) -> tuple[int, int] | None:
        """The open cell nearest to a cell, itself if it is open; None if there is none near."""
        within = math.ceil(_START_WITHIN_M / self.grid.resolution_m)
        nearest = nearest_open_cell(self.is_open, row, column, within)
        return None if nearest[0] < 0 else nearest
