"""What of a known floor the present search has looked at."""

import math
from dataclasses import dataclass, replace

import cv2
import numpy as np
from jaxtyping import Bool

from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.observation import Observation
from hypernav.mapping.memory.image_kernels import fan_of_view

_EVERY_PX = 16
_BESIDE_M = 0.3
"""Radius around the robot within which the floor counts as looked at, metres."""


@dataclass(eq=False)
class LookedOver:
    """The cells of a floor that the images of this search have shown.

    Things move, and detectors overlook them: where nothing new is left to explore, the search goes
    on where it has not looked yet itself.

    Attributes:
        cells: Mask of the cells.
        origin: Lower left corner ``(x, y)`` of the mask, metres.
    """

    cells: Bool[np.ndarray, "rows columns"]
    origin: tuple[float, float]

    @staticmethod
    def nothing(grid: OccupancyGrid) -> "LookedOver":
        """Nothing of a floor."""
        return LookedOver(np.zeros(grid.cells.shape, dtype=bool), grid.origin)

    def add(self, observation: Observation, grid: OccupancyGrid) -> None:
        """Add what an image shows: in every direction up to the farthest that has depth."""
        self._grow(grid)
        lens, pose = observation.camera.lens, observation.camera_to_map.rows
        farthest, side = observation.farthest_m, grid.resolution_m
        mask = self.cells.view(np.uint8)
        cv2.fillPoly(mask, [fan_of_view(farthest, _EVERY_PX, lens, pose, self.origin, side)], 1)
        row, column = grid.cell_of(*observation.robot.xy)
        cv2.circle(mask, (column, row), math.ceil(_BESIDE_M / side), 1, -1)

    def applied(self, grid: OccupancyGrid) -> OccupancyGrid:
        """The map as if only this search had been on the floor: the rest is unknown."""
        self._grow(grid)
        return replace(grid, cells=np.where(self.cells, grid.cells, np.uint8(Cell.UNKNOWN)))

    def _grow(self, grid: OccupancyGrid) -> None:
        """Cover the cells of a map, which only grows."""
        if self.cells.shape == grid.cells.shape and self.origin == grid.origin:
            return
        column, row = (
            round((old - new) / grid.resolution_m)
            for old, new in zip(self.origin, grid.origin, strict=True)
        )
        grown = np.zeros(grid.cells.shape, dtype=bool)
        rows, columns = self.cells.shape
        grown[row : row + rows, column : column + columns] = self.cells
        self.cells, self.origin = grown, grid.origin
