"""The part of the known map that the robot can reach, and the distances in it."""

import math
from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float32, UInt8

from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.mapping.config import MappingConfig
from hypernav.mapping.distance_kernels import nearest_open_cell, travel_cells
from hypernav.mapping.inflation import Escape, inflate


@dataclass(frozen=True, eq=False)
class ReachableArea:
    """The explored part of the map, and what of it the robot can reach from its position.

    Attributes:
        grid: Cropped map.
        travel_m: Length of the robot's path to every cell over free floor, clear of obstacles,
            metres; infinite where none leads.
        reachable: Mask of the reachable cells: 1 where `travel_m` is finite and the cell is free.
        frontier: Mask of the free cells that touch the unknown and can be looked into from a
            reachable cell, in stretches that are long enough.
        look_within: Number of rows and columns on each side of a frontier cell within which that
            reachable cell lies.
    """

    grid: OccupancyGrid
    travel_m: Float32[np.ndarray, "rows columns"]
    reachable: UInt8[np.ndarray, "rows columns"]
    frontier: Bool[np.ndarray, "rows columns"]
    look_within: int

    @staticmethod
    def of(
        grid: OccupancyGrid, robot: Pose2, config: MappingConfig, clearance_m: float
    ) -> "ReachableArea":
        """Find the reachable area around the robot.

        Args:
            grid: The map.
            robot: Pose of the robot. If its cell is closed, paths begin at the nearest open cell
                along a path.
            config: Length of the shortest frontier.
            clearance_m: Distance from obstacles that the robot's middle keeps, metres.
        """
        grid = grid.cropped()
        size = grid.resolution_m
        free = grid.cells == Cell.FREE
        occupied = grid.cells == Cell.OCCUPIED
        closed = inflate(occupied, clearance_m, size)
        is_open = free & (closed == 0)
        here = grid.cell_of(*robot.xy)
        if not config.free_footprint:
            # The robot stands on floor that no image showed: paths may begin there all the same.
            is_open |= _around(grid, here, clearance_m) & (closed == 0)
        is_open = is_open.view(np.uint8)
        escape = Escape.find(occupied, is_open, here, size)
        if escape is None:
            travel_m = np.full(free.shape, np.inf, dtype=np.float32)
        else:
            travel_m = travel_cells(is_open, *escape.exit)
            travel_m *= np.float32(size)
        reachable = (np.isfinite(travel_m) & free).view(np.uint8)
        # A frontier beside an obstacle is seen from a clearance away, and one cell for diagonals.
        look_m = clearance_m + size
        in_view = inflate(reachable, look_m, size) > 0
        beside_unknown = inflate(grid.cells == Cell.UNKNOWN, size, size, outside=True) > 0
        return ReachableArea(
            grid=grid,
            travel_m=travel_m,
            reachable=reachable,
            frontier=_long_stretches(
                free & beside_unknown & in_view, config.frontier_min_size_m / size
            ),
            look_within=math.ceil(look_m / size),
        )

    def look_out(self, row: int, column: int) -> tuple[int, int]:
        """The reachable cell ``(row, column)`` that is nearest to a frontier cell."""
        return nearest_open_cell(self.reachable, row, column, self.look_within)


def _around(
    grid: OccupancyGrid, here: tuple[int, int], radius_m: float
) -> Bool[np.ndarray, "rows columns"]:
    """Mask of the grid's cells within a radius of a cell."""
    rows, columns = np.ogrid[: grid.cells.shape[0], : grid.cells.shape[1]]
    squared = (rows - here[0]) ** 2 + (columns - here[1]) ** 2
    return squared <= (radius_m / grid.resolution_m) ** 2


def _long_stretches(
    cells: Bool[np.ndarray, "rows columns"], least_cells: float
) -> Bool[np.ndarray, "rows columns"]:
    """Mask of the cells in 8-connected parts of at least so many cells."""
    # OpenCV's statistics of the parts would take ten times as long as the parts.
    _, parts = cv2.connectedComponents(cells.view(np.uint8), connectivity=8)
    part_of = parts[cells].astype(np.intp)
    is_long = np.bincount(part_of) >= least_cells - 1e-9
    long = np.zeros(cells.shape, dtype=bool)
    long[cells] = is_long[part_of]
    return long
