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
    """

    x: float
    y: float
    reason: str
    blocks: tuple[Block, ...] = ()
    is_sighting: bool = False

    @property
    def xy(self) -> tuple[float, float]:
        """The position, metres."""
        return (self.x, self.y)
