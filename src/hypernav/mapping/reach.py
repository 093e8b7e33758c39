"""What the robot can reach over the known map, and how far that is."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float32

from hypernav.core.geometry import Pose2
from hypernav.core.grid import OccupancyGrid
from hypernav.mapping.config import MappingConfig
from hypernav.mapping.travel_kernels import FARTHEST, travel_tenths


@dataclass(frozen=True, eq=False)
class Reach:
    """The explored part of the map as seen from where the robot stands.

    Attributes:
        grid: The cropped map.
        travel_m: Length of the way to every cell over free floor, keeping clear of obstacles;
            infinite where none leads.
        frontier: Free cells that touch the unknown and can be looked into from a reachable cell.
        near_m: For every cell the shortest way to a reachable cell next to it.
    """

    grid: OccupancyGrid
    travel_m: Float32[np.ndarray, "rows columns"]
    frontier: Bool[np.ndarray, "rows columns"]
    near_m: Float32[np.ndarray, "rows columns"]

    @staticmethod
    def of(grid: OccupancyGrid, robot: Pose2, config: MappingConfig) -> "Reach":
        """Look at a map from the robot's place."""
        grid = grid.cropped()
        free = grid.free
        closed = cv2.dilate(
            grid.occupied.astype(np.uint8), _disc(config.clearance_m, grid.resolution_m)
        )
        is_open = free & (closed == 0)
        start = _nearest_open(is_open, grid.cell_of(*robot.xy))
        travel = np.full(free.shape, np.inf, dtype=np.float32)
        if start is not None:
            tenths = travel_tenths(is_open, *start)
            reached = tenths < FARTHEST
            travel[reached] = tenths[reached] * np.float32(grid.resolution_m / 10.0)
        margin = _disc(config.clearance_m + grid.resolution_m, grid.resolution_m)
        near = cv2.erode(travel, margin, borderValue=np.inf)
        unknown = cv2.dilate((~grid.explored).astype(np.uint8), _CROSS) > 0
        return Reach(grid, travel, free & unknown & np.isfinite(near), near)

    def closest_to(self, row: float, column: float, among: Bool[np.ndarray, "r c"]) -> np.ndarray:
        """The cell ``[row, column]`` of a non-empty set that is nearest to a place."""
        cells = np.argwhere(among)
        away = ((cells - np.array([row, column])) ** 2).sum(axis=1)
        return cells[int(away.argmin())]


_CROSS = np.array([[0, 1, 0], [1, 1, 1], [0, 1, 0]], dtype=np.uint8)


def _disc(radius_m: float, cell_m: float) -> np.ndarray:
    reach = int(np.ceil(radius_m / cell_m - 1e-9))
    offsets = np.arange(-reach, reach + 1)
    squared = offsets[:, None] ** 2 + offsets[None, :] ** 2
    return (squared <= (radius_m / cell_m) ** 2 + 1e-9).astype(np.uint8)


def _nearest_open(
    is_open: Bool[np.ndarray, "rows columns"], cell: tuple[int, int], within: int = 20
) -> tuple[int, int] | None:
    row, column = cell
    top, left = max(row - within, 0), max(column - within, 0)
    around = np.argwhere(is_open[top : row + within + 1, left : column + within + 1])
    if len(around) == 0:
        return None
    cells = around + np.array([top, left])
    nearest = cells[int(((cells - np.array(cell)) ** 2).sum(axis=1).argmin())]
    return int(nearest[0]), int(nearest[1])
