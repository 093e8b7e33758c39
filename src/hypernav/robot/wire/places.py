"""Places that people send a robot to during its search, and those that they close to it."""

from pydantic import Field

from hypernav.core.exploring.operator_place import PlaceState
from hypernav.robot.wire.values import InMap, Message

GO_TO = "go-to"
"""Path of the place that a robot is sent to, below that of a search."""
MOST_SENT = 1000
"""Largest number of places that the robot of a search is ever sent to."""
NO_ENTRY = "no-entry"
"""Path of the closed places below that of a search; that of one is ``no-entry/NUMBER``."""
MOST_CLOSED = 100
"""Largest number of places that a search has ever closed, those opened again included."""


class GoToRequest(Message):
    """A place that the robot is to go to.

    Attributes:
        x: Position along the x axis, ``map`` frame of the search, metres.
        y: Position along the y axis, metres.
        floor: Number of the floor, as ``floor`` in a step of the trace; 1 where a step has none.
    """

    x: InMap
    y: InMap
    floor: int = Field(default=1, ge=1, le=1000)


class GoToPlace(GoToRequest):
    """The same, and what has come of it.

    Attributes:
        state: What has come of it so far.
        away_m: Distance from the robot to the place when its way there ended, metres; None as long
            as it is on its way.
    """

    state: PlaceState = PlaceState.ON_ITS_WAY
    away_m: float | None = None


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
