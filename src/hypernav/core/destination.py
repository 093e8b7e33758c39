"""Where the robot is going while the goal is out of sight."""

from dataclasses import dataclass

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
