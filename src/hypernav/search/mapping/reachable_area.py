"""The part of the known map that the robot can reach, distances in it, and its frontiers.

Frontiers are the boundaries between known free floor and the unknown.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float32, Float64, Int64, UInt8

from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.grid_kernels import nearest_open_cell, travel_cells
from hypernav.search.mapping.inflation import Escape, inflate


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


@dataclass(frozen=True, eq=False)
class Frontier:
    """A connected stretch of boundary to the unknown.

    Source: Yamauchi, "A Frontier-Based Approach for Autonomous Exploration", 1997.

    Attributes:
        points: Middles of the frontier's cells, ``(x, y)``, ``map`` frame, metres.
        size_m: Length of the frontier: number of cells times cell size, metres.
        destination: Reachable position ``(x, y)`` from which the robot can look across it, metres.
        travel_m: Length of the robot's path there, metres.
    """

    points: Float64[np.ndarray, "n 2"]
    size_m: float
    destination: tuple[float, float]
    travel_m: float


def find_frontiers(
    grid: OccupancyGrid, robot: Pose2, config: MappingConfig, clearance_m: float
) -> list[Frontier]:
    """All frontiers that the robot can reach, in the order of their lowest, leftmost cells.

    Args:
        grid: The map.
        robot: Pose of the robot.
        config: Length of the shortest frontier.
        clearance_m: Distance from obstacles that the robot's middle keeps, metres.
    """
    return frontiers_of(ReachableArea.of(grid, robot, config, clearance_m))


def frontiers_of(reach: ReachableArea) -> list[Frontier]:
    """The frontiers of a reachable area, in the order of their lowest, leftmost cells."""
    _, parts = cv2.connectedComponents(reach.frontier.view(np.uint8), connectivity=8)
    flat = np.flatnonzero(reach.frontier)
    cells = np.stack(np.divmod(flat, reach.frontier.shape[1]), axis=1)
    _, first, part, sizes = np.unique(
        parts.ravel()[flat], return_index=True, return_inverse=True, return_counts=True
    )
    groups = np.split(cells[np.argsort(part, kind="stable")], np.cumsum(sizes)[:-1])
    return [_frontier(reach, groups[i]) for i in np.argsort(first)]


def fresh_frontiers(
    grid: OccupancyGrid,
    robot: Pose2,
    config: MappingConfig,
    clearances_m: Sequence[float],
    *,
    visits: Sequence[tuple[float, float]] = (),
    visited_radius_m: float = 0.0,
) -> list[Frontier]:
    """The reachable frontiers that were not visited yet.

    Args:
        grid: The map.
        robot: Pose of the robot.
        config: Length of the shortest frontier.
        clearances_m: Distances from obstacles that the robot's middle keeps, metres: the first with
            which such a frontier is found counts.
        visits: Positions ``(x, y)`` that were visited, metres.
        visited_radius_m: Distance from a visit, metres, within which a destination is visited.
    """
    for clearance_m in clearances_m:
        fresh = [
            frontier
            for frontier in find_frontiers(grid, robot, config, clearance_m)
            if all(math.dist(frontier.destination, one) >= visited_radius_m for one in visits)
        ]
        if fresh:
            return fresh
    return []


def _frontier(reach: ReachableArea, cells: Int64[np.ndarray, "n 2"]) -> Frontier:
    away = ((cells - cells.mean(axis=0)) ** 2).sum(axis=1)
    row, column = cells[int(away.argmin())]
    destination = reach.look_out(int(row), int(column))
    return Frontier(
        points=reach.grid.centres_of(cells),
        size_m=len(cells) * reach.grid.resolution_m,
        destination=reach.grid.centre_of(*destination),
        travel_m=float(reach.travel_m[destination]),
    )
