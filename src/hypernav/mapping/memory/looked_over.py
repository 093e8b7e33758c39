"""What of a known floor the present search has looked at."""

import math
from dataclasses import dataclass, replace

import cv2
import numpy as np
from jaxtyping import Bool

from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.observation import Observation

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
        camera, robot = observation.camera, observation.robot
        columns = np.arange(0, camera.width, _EVERY_PX)
        depth = observation.farthest_m[columns].astype(np.float64)
        aside = depth * (columns + 0.5 - camera.cx) / camera.fx
        pose = observation.camera_to_map
        fan = np.zeros((len(columns) + 1, 2))  # begins at the camera
        fan[1:] = np.outer(aside, pose.rotation[:2, 0]) + np.outer(depth, pose.rotation[:2, 2])
        corners = (fan + (pose.translation[:2] - self.origin)) / grid.resolution_m
        mask = self.cells.view(np.uint8)
        cv2.fillPoly(mask, [np.floor(corners).astype(np.int32)], 1)
        row, column = grid.cell_of(*robot.xy)
        cv2.circle(mask, (column, row), math.ceil(_BESIDE_M / grid.resolution_m), 1, -1)

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
