"""The ground around a robot that climbs: what of it can be walked on, and how high it is."""

import math
from dataclasses import dataclass, replace

import cv2
import numpy as np
from jaxtyping import Bool, Float32, Float64

from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.mapping.distance_kernels import nearest_open_cell

_NEAR_M = 0.4
"""Distance within which the ground under the robot is looked for, metres."""


@dataclass(frozen=True, eq=False)
class Ground:
    """The part of the ground that the robot could walk to over steps that it can climb.

    Attributes:
        grid: The open ground, free where the robot could step on it and occupied elsewhere.
        heights: Height of the ground, ``map`` frame, metres: where steps down are presumed an upper
            bound; NaN where nothing is known.
        seen: Mask of the cells whose ground was seen; other heights are filled in.
        clearance_m: Distance of every cell from what is not open ground, metres.
        reached: Mask of the cells where the robot's middle could get.
        presumed: Mask of the cells where stairs down are presumed, since no ground was seen at the
            robot's height, but what lies below it.
        least_m: Clearance that the robot's middle needs, metres.
    """

    grid: OccupancyGrid
    heights: Float32[np.ndarray, "rows columns"]
    seen: Bool[np.ndarray, "rows columns"]
    clearance_m: Float32[np.ndarray, "rows columns"]
    reached: Bool[np.ndarray, "rows columns"]
    presumed: Bool[np.ndarray, "rows columns"]
    least_m: float

    def without(
        self, closed: Bool[np.ndarray, "rows columns"], position: tuple[float, float]
    ) -> "Ground":
        """The ground where some cells are closed, as far as it is in reach from a position."""
        cells = np.where(closed, np.uint8(Cell.OCCUPIED), self.grid.cells)
        grid = replace(self.grid, cells=cells)
        clearance_m, reached = reach(grid, position, self.least_m)
        return replace(self, grid=grid, clearance_m=clearance_m, reached=reached)

    def between(self, low_m: float, high_m: float) -> Bool[np.ndarray, "rows columns"]:
        """Mask of the reached cells whose heights lie between two, metres."""
        with np.errstate(invalid="ignore"):
            return self.reached & (self.heights >= low_m) & (self.heights <= high_m)

    def area_m2(self, mask: Bool[np.ndarray, "rows columns"]) -> float:
        """Area of a mask's cells, square metres."""
        return float(mask.sum()) * self.grid.resolution_m**2

    def nearest_reached(self, position: tuple[float, float]) -> tuple[int, int] | None:
        """The reached cell ``(row, column)`` nearest to a position; None if none is near it."""
        return nearest_cell(self.reached, self.grid, position)

    def distances_m(self, position: tuple[float, float]) -> Float64[np.ndarray, "rows columns"]:
        """Straight distances of all cells from a position, metres."""
        row, column = self.grid.cell_of(*position)
        rows, columns = np.ogrid[: self.heights.shape[0], : self.heights.shape[1]]
        return np.hypot(rows - row, columns - column) * self.grid.resolution_m

    def along(
        self, position: tuple[float, float], axis: float
    ) -> tuple[Float64[np.ndarray, "rows columns"], Float64[np.ndarray, "rows columns"]]:
        """How far ahead of a position along an axis (radians), and beside it, cells lie, metres."""
        row, column = self.grid.cell_of(*position)
        rows, columns = np.ogrid[: self.heights.shape[0], : self.heights.shape[1]]
        y, x = (rows - row) * self.grid.resolution_m, (columns - column) * self.grid.resolution_m
        cos, sin = math.cos(axis), math.sin(axis)
        return x * cos + y * sin, np.abs(y * cos - x * sin)

    def positions(self, mask: Bool[np.ndarray, "rows columns"]) -> Float64[np.ndarray, "n 2"]:
        """Middles ``(x, y)`` of a mask's cells, metres."""
        return self.grid.centres_of(np.argwhere(mask))


def reach(
    grid: OccupancyGrid, position: tuple[float, float], least_m: float
) -> tuple[Float32[np.ndarray, "rows columns"], Bool[np.ndarray, "rows columns"]]:
    """The clearance of all cells from what is not free, metres, and those in reach of a position.

    Args:
        grid: Free and other cells.
        position: The robot ``(x, y)``, metres.
        least_m: Clearance that its middle needs, metres.
    """
    is_open = (grid.cells == Cell.FREE).view(np.uint8)
    clearance = cv2.distanceTransform(is_open, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    clearance_m = clearance * np.float32(grid.resolution_m)
    fits = clearance_m > least_m
    start = nearest_cell(fits, grid, position)
    if start is None:
        return clearance_m, np.zeros_like(fits)
    _, parts = cv2.connectedComponents(fits.view(np.uint8), connectivity=4)
    return clearance_m, parts == parts[start]


def nearest_cell(
    mask: Bool[np.ndarray, "rows columns"], grid: OccupancyGrid, position: tuple[float, float]
) -> tuple[int, int] | None:
    """The cell of a mask nearest to a position; None if none is within `_NEAR_M`."""
    within = math.ceil(_NEAR_M / grid.resolution_m)
    cell = nearest_open_cell(mask.view(np.uint8), *grid.cell_of(*position), within)
    return None if cell == (-1, -1) else cell
