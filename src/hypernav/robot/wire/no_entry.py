"""Places that people close to a robot during its search."""

from pydantic import Field

from hypernav.robot.wire.values import InMap, Message

NO_ENTRY = "no-entry"
"""Path of the closed places below that of a search; that of one is ``no-entry/NUMBER``."""
MOST_CLOSED = 100
"""Largest number of places that a search has ever closed, those opened again included."""


class NoEntryRequest(Message):
    """A round place that the robot is not to enter.

    Attributes:
        x: Middle along the x axis, ``map`` frame of the search, metres.
        y: Middle along the y axis, metres.
        radius_m: Radius, metres; the robot's body keeps out of it, as of an obstacle.
        floor: Number of the floor, as ``floor`` in a step of the trace; 1 where a step has none.
    """

    x: InMap
    y: InMap
    radius_m: float = Field(default=0.5, ge=0.1, le=5.0)
    floor: int = Field(default=1, ge=1, le=1000)


class NoEntryArea(NoEntryRequest):
    """The same with the number by which it is opened again."""

    number: int = Field(ge=0)
