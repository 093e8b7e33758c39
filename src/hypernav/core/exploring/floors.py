"""Stairs, and the floors that they lead to, as explorers are told of them."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from hypernav.core.exploring.sightings import SeenThing
from hypernav.core.geometry.grid import OccupancyGrid


@dataclass(frozen=True)
class WayOut:
    """Stairs or a ramp from the robot's floor towards floors where something may be unseen.

    Attributes:
        connector: Number of the connector in the memory.
        x: Position before it along the x axis, ``map`` frame, metres.
        y: Position before it along the y axis, ``map`` frame, metres.
        words: Name for models and people, such as "stairs up".
        axis: Direction in which they lead away from there, ``map`` frame, radians.
        to: Number of the floor that they lead to; None if nobody knows.
    """

    connector: int
    x: float
    y: float
    words: str
    axis: float = 0.0
    to: int | None = None

    @property
    def xy(self) -> tuple[float, float]:
        """The position, metres."""
        return (self.x, self.y)


@dataclass(frozen=True)
class Drop:
    """A place where the floor ends, as at the head of stairs.

    Attributes:
        x: Position along the x axis, ``map`` frame, metres.
        y: Position along the y axis, ``map`` frame, metres.
        axis: Direction in which stairs seemed to lead down there, ``map`` frame, radians; None if
            no image has shown any.
    """

    x: float
    y: float
    axis: float | None = None

    @property
    def xy(self) -> tuple[float, float]:
        """The position, metres."""
        return (self.x, self.y)


@dataclass(frozen=True, eq=False)
class KnownFloor:
    """Another floor that the robot knows, and knows a way to.

    Attributes:
        number: Its number, in the order in which the robot came to know floors.
        above_m: Its height above the floor that the robot is on, metres; below it less than 0.
        grid: Map of it.
        trajectory: Positions ``(x, y)`` of the robot on it, ``map`` frame, metres.
        visits: Destinations on it that were reached or given up, as in `ExplorationView`.
        things: Things that were seen on it, other than the goal.
        stairs: Stairs on it that the robot may take; as in `ExplorationView.ways_out`, new ones
            only towards floors that it knows no way to.
        way: Stairs that lead to it, in the order in which the robot takes them, one a floor.
        arrival: Position ``(x, y)`` on it where the way ends, ``map`` frame, metres.
        notes: What explorers keep from choice to choice there, as in `ExplorationView`.
        was_explored: Whether a search, this one or an earlier one, left nothing to explore on it.
    """

    number: int
    above_m: float
    grid: OccupancyGrid
    trajectory: Sequence[tuple[float, float]]
    visits: Sequence[tuple[float, float]]
    things: Sequence[SeenThing]
    stairs: Sequence[WayOut]
    way: tuple[WayOut, ...]
    arrival: tuple[float, float]
    notes: dict[str, Any] = field(default_factory=dict)
    was_explored: bool = False

    @property
    def words(self) -> str:
        """Name for models and people, such as "floor 2, 3.0 m higher"."""
        away = f"{abs(self.above_m):.1f} m {'higher' if self.above_m > 0.0 else 'lower'}"
        return f"floor {self.number + 1}, {away}"
