"""Destinations of the robot while the goal is out of sight."""

from dataclasses import dataclass

from hypernav.core.overview import Block


@dataclass(frozen=True)
class Destination:
    """A position that the robot is going to, by global perception.

    Attributes:
        x: Position along the x axis, ``map`` frame, metres.
        y: Position along the y axis, ``map`` frame, metres.
        reason: Reason for the choice, in one short sentence for people.
        blocks: Blocks that were offered, for the trace; empty for explorers without blocks.
        is_sighting: Whether the goal is in sight in this direction, so that no explorer chose it.
        holds: Whether nothing that the map shows on the way ends it: a move chosen from an image is
            made to its end.
        arrival_m: Distance within which it counts as reached, metres; None leaves it to the search.
        face: Heading to turn to on arrival, ``map`` frame, radians; None keeps the heading.
        most_steps: Number of steps after which the explorer is asked again; None leaves the
            destination standing. The same answer again is the same destination.
    """

    x: float
    y: float
    reason: str
    blocks: tuple[Block, ...] = ()
    is_sighting: bool = False
    holds: bool = False
    arrival_m: float | None = None
    face: float | None = None
    most_steps: int | None = None

    @property
    def xy(self) -> tuple[float, float]:
        """The position, metres."""
        return (self.x, self.y)
