"""Exploration: what an explorer is shown, and where it sends the robot."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from hypernav.core.exploring.floors import Drop, KnownFloor, SeenThing, WayOut
from hypernav.core.exploring.insight import Insight
from hypernav.core.exploring.overview import Block
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation


@dataclass(frozen=True, eq=False)
class ExplorationView:
    """Everything that an explorer may know when it chooses where to go.

    Attributes:
        goal: Target of the search.
        observation: Present frame.
        grid: Map of the floor that the robot is on, with this frame in it.
        trajectory: Positions ``(x, y)`` of the robot on this floor at every step, the present one
            included; ``map`` frame, metres.
        visits: Destinations ``(x, y)`` on this floor that were reached or given up in the search
            for this goal, the oldest first; metres. A turn on the spot is no visit.
        things: Things that were seen on this floor, other than the goal.
        floor: Number of the floor, in the order in which the robot came to know them.
        notes: Explorers' own notes on this floor for this goal, each under a key of its own; the
            only part of the view that they may change. The memory keeps them, so they hold plain
            values, arrays or generators that can be copied, and no component.
        ways_out: Stairs that the robot has not taken yet, up or down where it knows no path to the
            next floor. Others, and those to floors that it left before all was seen, are taken
            where the explorer has nothing left to offer.
        elsewhere: Other floors that the robot knows, those with the fewest stairs on the way first.
        drops: Where the floor ends, so that stairs down may begin there, and where stairs down seem
            to. There are none where the robot knows a path to the next floor down.
        may_be_here: Whether a component has just said that the goal is where the robot is.
    """

    goal: Goal
    observation: Observation
    grid: OccupancyGrid
    trajectory: Sequence[tuple[float, float]]
    visits: Sequence[tuple[float, float]] = ()
    things: Sequence[SeenThing] = ()
    floor: int = 0
    notes: dict[str, Any] = field(default_factory=dict)
    ways_out: Sequence[WayOut] = ()
    elsewhere: Sequence[KnownFloor] = ()
    drops: Sequence[Drop] = ()
    may_be_here: bool = False

    @property
    def robot(self) -> Pose2:
        """Pose of the robot, ``map`` frame."""
        return self.observation.robot


@dataclass(frozen=True)
class Aim:
    """What the robot goes to.

    Attributes:
        x: Position along the x axis, ``map`` frame, metres.
        y: Position along the y axis, ``map`` frame, metres.
        reason: Reason for the choice, in one short sentence for people.
    """

    x: float
    y: float
    reason: str

    @property
    def xy(self) -> tuple[float, float]:
        """The position, metres."""
        return (self.x, self.y)


@dataclass(frozen=True)
class Destination(Aim):
    """A position on the robot's floor, chosen by global perception.

    Attributes:
        x: Position along the x axis, ``map`` frame, metres.
        y: Position along the y axis, ``map`` frame, metres.
        reason: Reason for the choice, in one short sentence for people.
        blocks: Blocks that were offered, for the trace; empty for explorers without blocks.
        insight: What the explorer looked at when it chose, for videos and pages.
        holds: Whether it stays valid whatever the map shows on the way: a move chosen from an
            image is made to its end.
        arrival_m: Distance within which it counts as reached, metres; None leaves it to the search.
        face: Heading to turn to on arrival, ``map`` frame, radians; None keeps the heading.
        most_steps: Number of steps after which the explorer is asked again; None sets no limit.
            The same answer again is the same destination.
    """

    blocks: tuple[Block, ...] = ()
    insight: Insight | None = None
    holds: bool = False
    arrival_m: float | None = None
    face: float | None = None
    most_steps: int | None = None


@dataclass(frozen=True)
class StairsDestination(Aim):
    """Stairs that the robot takes to another floor, chosen by global perception.

    Attributes:
        x: Position before them along the x axis, ``map`` frame, metres.
        y: Position before them along the y axis, ``map`` frame, metres.
        reason: Reason for the choice, in one short sentence for people.
        connector: Number of the connector, as in `ExplorationView.ways_out`.
        then: Destination on the floor that it leads to; None if there is none yet.
        blocks: Blocks that were offered, as in `Destination`.
        insight: What the explorer looked at, as in `Destination`.
    """

    connector: int
    then: "Destination | StairsDestination | None" = None
    blocks: tuple[Block, ...] = ()
    insight: Insight | None = None


Chosen = Destination | StairsDestination
"""What an explorer chooses."""
