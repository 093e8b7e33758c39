"""A place that people send a robot to during its search, and what comes of it."""

from dataclasses import dataclass
from enum import StrEnum


@dataclass(frozen=True)
class OperatorPlace:
    """A place on the map that the robot is to go to.

    Attributes:
        floor: Number of the floor, from 1.
        x: Position along the x axis, ``map`` frame, metres.
        y: Position along the y axis, ``map`` frame, metres.
    """

    floor: int
    x: float
    y: float

    @property
    def xy(self) -> tuple[float, float]:
        """The position, metres."""
        return (self.x, self.y)


class PlaceState(StrEnum):
    """What has come of it so far; all but the first are final."""

    ON_ITS_WAY = "on its way"
    REACHED = "reached"
    """The robot is there, or at the nearest position within 1 m that is known to be free."""
    NO_PATH = "no path over what is known"
    NO_PROGRESS = "no progress"
    """The robot gets no nearer, although the map shows a path."""

    @property
    def event(self) -> str:
        """The event by which the trace of an agent says so, once."""
        return f"place chosen on the map: {self}"
