"""Where a search goes: what its explorer chooses, what it sees far away, and what it remembers."""

from dataclasses import dataclass

from hypernav.core.exploring.exploration import Aim, Chosen, Destination, StairsDestination
from hypernav.search.agents.config import SearchConfig

BESIDE_M = 1.0
"""Distance, metres, of a position that stands in for a thing or place that can't be entered."""


@dataclass(frozen=True)
class Sighting(Aim):
    """The goal, seen in this direction too far away, or from another floor."""


@dataclass(frozen=True)
class RememberedThing(Aim):
    """A position beside a remembered thing that may be the goal.

    Attributes:
        face: Heading from there to the thing, ``map`` frame, radians.
        thing: Number of the thing.
    """

    face: float
    thing: int


@dataclass(frozen=True)
class RememberedImage(Aim):
    """The position where a key image was taken that may show the goal.

    Attributes:
        face: Heading of the robot in the image, ``map`` frame, radians.
        image: Number of the image.
    """

    face: float
    image: int


@dataclass(frozen=True)
class RememberedStairs(Aim):
    """Stairs to a floor where the goal was seen, or what may be it is remembered.

    Attributes:
        connector: Number of the connector.
    """

    connector: int


Remembered = RememberedThing | RememberedImage | RememberedStairs
"""What no explorer chose: it stays, whatever the map shows on the way."""
OverStairs = StairsDestination | RememberedStairs
AnyDestination = Chosen | Sighting | Remembered


def beyond_stairs(destination: OverStairs) -> Chosen | None:
    """Where to go on beyond stairs; None if that is chosen there."""
    return destination.then if isinstance(destination, StairsDestination) else None


def arrival_m_of(destination: AnyDestination, config: SearchConfig) -> float:
    """Distance within which a destination counts as reached, metres."""
    own_m = destination.arrival_m if isinstance(destination, Destination) else None
    return own_m or config.arrival_distance_m
