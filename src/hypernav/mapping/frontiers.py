"""Frontiers: where known free floor borders on the unknown."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float64, Int64

from hypernav.core.geometry import Pose2
from hypernav.core.grid import OccupancyGrid
from hypernav.mapping.config import MappingConfig
from hypernav.mapping.reach import Reach


@dataclass(frozen=True, eq=False)
class Frontier:
    """A connected stretch of boundary to the unknown.

    Source: Yamauchi, "A Frontier-Based Approach for Autonomous Exploration", 1997.

    Attributes:
        points: Middles of its cells, ``(x, y)``, metres.
        size_m: Its length: number of cells times cell size.
        destination: Where the robot would go to look across it: a reachable place, metres.
        travel_m: Length of the way there.
    """

    points: Float64[np.ndarray, "n 2"]
    size_m: float
    destination: tuple[float, float]
    travel_m: float


def find_frontiers(grid: OccupancyGrid, robot: Pose2, config: MappingConfig) -> list[Frontier]:
    """All frontiers that the robot can reach, in the order of their lowest, leftmost cells.

    Args:
        grid: The map.
        robot: Where the robot is.
        config: Smallest size and clearance.
    """
    reach = Reach.of(grid, robot, config)
    count, parts, stats, middles = cv2.connectedComponentsWithStats(
        reach.frontier.astype(np.uint8), connectivity=8
    )
    frontiers = []
    for part in range(1, count):
        left, bottom, width, height, cells = stats[part]
        if cells * grid.resolution_m < config.frontier_min_size_m:
            continue
        window = (slice(bottom, bottom + height), slice(left, left + width))
        inside = parts[window] == part
        corner = np.array([bottom, left])
        middle = reach.closest_to(middles[part][1] - bottom, middles[part][0] - left, inside)
        frontiers.append(_frontier(reach, np.argwhere(inside) + corner, middle + corner))
    return frontiers


def _frontier(
    reach: Reach, cells: Int64[np.ndarray, "n 2"], middle: Int64[np.ndarray, "2"]
) -> Frontier:
    destination = look_out(reach, int(middle[0]), int(middle[1]))
    return Frontier(
        points=reach.grid.centres_of(cells),
        size_m=len(cells) * reach.grid.resolution_m,
        destination=reach.grid.centre_of(*destination),
        travel_m=float(reach.travel_m[destination]),
    )


def look_out(reach: Reach, row: int, column: int, within: int = 8) -> tuple[int, int]:
    """The reachable cell nearest to a frontier cell."""
    top, left = max(row - within, 0), max(column - within, 0)
    around = np.isfinite(reach.travel_m[top : row + within + 1, left : column + within + 1])
    nearest = reach.closest_to(row - top, column - left, around)
    return int(nearest[0]) + top, int(nearest[1]) + left
