"""Where to go while the goal is out of sight."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from hypernav.core.geometry import Pose2
from hypernav.core.goal import Goal
from hypernav.core.grid import OccupancyGrid
from hypernav.core.overview import Block


@dataclass(frozen=True)
class Destination:
    """Where the robot is going now, by global perception.

    Attributes:
        x: ``map`` frame, metres.
        y: ``map`` frame, metres.
        reason: Why, in one short sentence for people.
        blocks: The blocks that were offered, for the trace; empty for explorers without blocks.
    """

    x: float
    y: float
    reason: str
    blocks: tuple[Block, ...] = ()

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
