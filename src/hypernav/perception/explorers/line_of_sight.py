"""Lines of sight on the map."""

import math

import numpy as np

from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2


def last_free_towards(
    grid: OccupancyGrid, robot: Pose2, bearing: float, *, reach_m: float = 8.0
) -> tuple[float, float]:
    """The last free point in a straight line from the robot before the unknown or an obstacle.

    Args:
        grid: The map.
        robot: Pose of the robot.
        bearing: Direction from the robot's heading, radians, positive to the left.
        reach_m: Length of the line, metres.

    Returns:
        Point ``(x, y)``, metres; the robot's own position if nothing ahead is free.
    """
    angle = robot.yaw + bearing
    along = np.arange(grid.resolution_m, reach_m, grid.resolution_m)
    points = np.array(robot.xy) + along[:, None] * np.array([math.cos(angle), math.sin(angle)])
    cells = grid.cells_of(points)
    inside = grid.contains(cells)
    states = np.full(len(points), Cell.UNKNOWN, dtype=np.uint8)
    states[inside] = grid.cells[cells[inside, 0], cells[inside, 1]]
    free = np.flatnonzero(states == Cell.FREE)
    # The floor right before the robot is below its image: skip what is not known there.
    walls = np.flatnonzero(states == Cell.OCCUPIED)
    before_wall = free[free < walls[0]] if len(walls) else free
    if len(before_wall) == 0:
        return robot.xy
    x, y = points[before_wall[-1]]
    return (float(x), float(y))
