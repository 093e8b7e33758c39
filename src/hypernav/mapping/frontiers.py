"""Frontiers: the boundaries between known free floor and the unknown."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float64, Int64

from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.mapping.config import MappingConfig
from hypernav.mapping.reachable_area import ReachableArea


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
