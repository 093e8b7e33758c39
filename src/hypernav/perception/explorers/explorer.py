"""Where to go while the goal is out of sight."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.overview import Block


@dataclass(frozen=True)
class Destination:
    """Where the robot is going now, by global perception.

    Attributes:
        x: ``map`` frame, metres.
        y: ``map`` frame, metres.
        reason: Why, in one short sentence for people.
        blocks: The blocks that were offered, for the trace; empty for explorers without blocks.
        is_sighting: It was not chosen by an explorer: the goal is in sight in this direction.
    """

    x: float
    y: float
    reason: str
    blocks: tuple[Block, ...] = ()
    is_sighting: bool = False

    @property
    def xy(self) -> tuple[float, float]:
        """The point, metres."""
        return (self.x, self.y)


@runtime_checkable
class Explorer(Protocol):
    """Chooses destinations from the map alone."""

    def reset(self, goal: Goal) -> None:
        """Forget all visits."""
        ...

    def remember_visit(self, x: float, y: float) -> None:
        """Note a destination that was reached or given up."""
        ...

    def next_destination(
        self, grid: OccupancyGrid, robot: Pose2, trajectory: Sequence[tuple[float, float]]
    ) -> Destination | None:
        """The next place to visit, or None if nothing is left to explore."""
        ...


@runtime_checkable
class Prefetches(Protocol):
    """An explorer that can choose the next destination while the robot drives to this one."""

    def prefetch(
        self,
        grid: OccupancyGrid,
        robot: Pose2,
        trajectory: Sequence[tuple[float, float]],
        destination: Destination,
    ) -> None:
        """Begin to choose, if it is time; called at every step of the way to a destination."""
        ...


def last_free_towards(
    grid: OccupancyGrid, robot: Pose2, bearing: float, *, reach_m: float = 8.0
) -> tuple[float, float]:
    """The last free point in a straight line from the robot before the unknown or an obstacle.

    Args:
        grid: The map.
        robot: Where the robot is.
        bearing: Direction from the robot's heading, radians, positive to the left.
        reach_m: How far to look.

    Returns:
        ``(x, y)``, metres; the robot's own place if nothing ahead is free.
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
