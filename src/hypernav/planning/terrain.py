"""What a way over the map costs: obstacles inflated, narrow and unknown places dearer."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float32

from hypernav.core.grid import OccupancyGrid
from hypernav.planning.config import PlanningConfig

_MARGIN_M = 1.0


@dataclass(frozen=True, eq=False)
class Terrain:
    """The explored part of the map with the cost of every cell.

    Attributes:
        grid: The cropped map.
        costs: Factor on the length of a way through a cell; 0 where the robot cannot be.
    """

    grid: OccupancyGrid
    costs: Float32[np.ndarray, "rows columns"]

    @staticmethod
    def of(grid: OccupancyGrid, config: PlanningConfig) -> "Terrain":
        """Inflate the obstacles of a map and price the rest."""
        grid = grid.cropped(_MARGIN_M)
        occupied = grid.occupied.astype(np.uint8)
        lethal = cv2.dilate(occupied, _disc(config.inflation_m, grid.resolution_m))
        costs = np.ones(grid.cells.shape, dtype=np.float32)
        if config.comfort_cost > 0.0 and config.comfort_m > 0.0:
            near = cv2.dilate(lethal, _disc(config.comfort_m, grid.resolution_m))
            costs += np.float32(config.comfort_cost) * near
        costs[~grid.explored] *= np.float32(config.unknown_cost)
        costs[lethal > 0] = 0.0
        return Terrain(grid, costs)

    def continuous(self, x: float, y: float) -> tuple[float, float]:
        """A point in continuous ``(row, column)`` cells."""
        origin, size = self.grid.origin, self.grid.resolution_m
        return ((y - origin[1]) / size, (x - origin[0]) / size)

    def nearest_open(self, row: int, column: int, reach: int = 20) -> tuple[int, int] | None:
        """The open cell nearest to a cell; None if there is none within reach (cells)."""
        rows, columns = self.costs.shape
        if 0 <= row < rows and 0 <= column < columns and self.costs[row, column] > 0:
            return row, column
        top, left = max(row - reach, 0), max(column - reach, 0)
        around = np.argwhere(self.costs[top : row + reach + 1, left : column + reach + 1] > 0)
        if len(around) == 0:
            return None
        cells = around + np.array([top, left])
        distances = ((cells - np.array([row, column])) ** 2).sum(axis=1)
        nearest = cells[int(distances.argmin())]
        return int(nearest[0]), int(nearest[1])


def _disc(radius_m: float, cell_m: float) -> np.ndarray:
    """A round structuring element of this radius."""
    reach = int(np.ceil(radius_m / cell_m))
    offsets = np.arange(-reach, reach + 1)
    squared = offsets[:, None] ** 2 + offsets[None, :] ** 2
    return (squared <= (radius_m / cell_m) ** 2 + 1e-9).astype(np.uint8)
