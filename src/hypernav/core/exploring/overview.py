"""The map as a question: numbered blocks, the image of them, and the answer."""

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float64, UInt8

from hypernav.core.exploring.floors import KnownFloor, SeenThing
from hypernav.core.geometry.transforms import Pose2


@dataclass(frozen=True)
class Block:
    """A labelled square of the explored map, the unit of a global answer.

    Attributes:
        number: Number on the label, from 1.
        x_min: Lower left corner in the ``map`` frame, metres.
        y_min: Lower left corner in the ``map`` frame, metres.
        size_m: Side length, metres.
        free_cells: Number of free cells in the block.
        frontier_cells: Number of free cells in the block that touch unknown cells.
        destination: Position ``(x, y)`` in the block that the robot would go to, metres; the middle
            of a free cell.
        travel_m: Length of the path there over the known map, metres; infinite if there is none.
        connector: Number of the connector that begins there; None for a part of the floor.
        words: Name of the connector, such as "stairs up", or of an edge of the floor; else empty.
        beyond_m2: Unknown floor that is expected beyond one of these, square metres.
        face: Heading to turn to there, radians; None keeps the heading.
    """

    number: int
    x_min: float
    y_min: float
    size_m: float
    free_cells: int
    frontier_cells: int
    destination: tuple[float, float]
    travel_m: float
    connector: int | None = None
    words: str = ""
    beyond_m2: float = 0.0
    face: float | None = None

    def holds(self, position: tuple[float, float]) -> bool:
        """Whether a position ``(x, y)``, metres, lies in the block."""
        x, y = position[0] - self.x_min, position[1] - self.y_min
        return 0.0 <= x < self.size_m and 0.0 <= y < self.size_m


@dataclass(frozen=True, eq=False)
class Prospects:
    """The unknown areas that visits to blocks would show.

    Attributes:
        areas_m2: Parts of the unknown floor, square metres.
        shows: Whether a block shows a part.
        positions: Centres ``(x, y)`` of the parts, ``map`` frame, metres.
    """

    areas_m2: Float64[np.ndarray, "areas"]
    shows: Bool[np.ndarray, "blocks areas"]
    positions: Float64[np.ndarray, "areas 2"]

    @property
    def gains_m2(self) -> Float64[np.ndarray, "blocks"]:
        """Area that each block would show, square metres."""
        return self.shows @ self.areas_m2


def prospects_of_boundaries(blocks: Sequence[Block]) -> Prospects:
    """Prospects from the blocks alone: each block shows its own boundary."""
    boundaries = np.array([block.frontier_cells for block in blocks], dtype=np.float64)
    return Prospects(boundaries, np.eye(len(blocks), dtype=bool), _destinations(blocks))


def straight_legs_m(blocks: Sequence[Block]) -> Float64[np.ndarray, "blocks blocks"]:
    """Straight-line distances between blocks, metres."""
    positions = _destinations(blocks)
    return np.linalg.norm(positions[:, None] - positions, axis=2)


def _destinations(blocks: Sequence[Block]) -> Float64[np.ndarray, "blocks 2"]:
    return np.array([block.destination for block in blocks], dtype=np.float64).reshape(-1, 2)


@dataclass(frozen=True, eq=False)
class FloorBlocks:
    """The blocks of another floor.

    Attributes:
        known: The floor.
        blocks: Its blocks; their paths begin at the robot, and stairs on the way are in them.
        visited: Numbers of those that count as visited, which no choice may name.
    """

    known: KnownFloor
    blocks: tuple[Block, ...]
    visited: frozenset[int] = field(default=frozenset(), kw_only=True)

    def prospects(self, blocks: Sequence[Block]) -> Prospects:
        """What visits to some of its blocks would show."""
        return prospects_of_boundaries(blocks)


@dataclass(frozen=True, eq=False)
class Overview:
    """Everything that a reasoner may know when it chooses a block.

    Attributes:
        blocks: Blocks of the robot's floor in the order of their numbers.
        robot: Pose of the robot, ``map`` frame.
        legend: Sentences that say what the colours and marks of the image mean.
        trajectory: Positions of the robot so far, ``map`` frame, metres.
        things: Things that were seen, other than the goal.
        camera_image: Camera image of the robot, RGB; None if it is not kept.
        elsewhere: Blocks of other floors, whose numbers follow those of `blocks`.
        seen_m2: Floor that the map shows, square metres.
    """

    blocks: tuple[Block, ...]
    robot: Pose2
    legend: str = ""
    trajectory: Sequence[tuple[float, float]] = ()
    things: Sequence[SeenThing] = ()
    camera_image: UInt8[np.ndarray, "height width 3"] | None = None
    elsewhere: Sequence[FloorBlocks] = ()
    seen_m2: float = math.inf

    def draw(
        self, shown: Collection[int], hatched: Collection[int]
    ) -> UInt8[np.ndarray, "height width 3"]:
        """The map with the blocks of these numbers, RGB; not every reasoner asks for it."""
        raise NotImplementedError

    def prospects(self, blocks: Sequence[Block]) -> Prospects:
        """What visits to some blocks of the robot's floor would show."""
        return prospects_of_boundaries(blocks)

    def legs_m(self, blocks: Sequence[Block]) -> Float64[np.ndarray, "blocks blocks"]:
        """Lengths of the paths between some blocks of the robot's floor, metres."""
        return straight_legs_m(blocks)

    @property
    def everywhere(self) -> tuple[Block, ...]:
        """The blocks of all floors in the order of their numbers."""
        return self.blocks + tuple(one for floor in self.elsewhere for one in floor.blocks)

    def floor_of(self, number: int) -> FloorBlocks | None:
        """The other floor that this block is on; None for the robot's floor."""
        if any(block.number == number for block in self.blocks):
            return None
        return next(
            floor for floor in self.elsewhere if number in (one.number for one in floor.blocks)
        )

    @cached_property
    def image(self) -> UInt8[np.ndarray, "height width 3"]:
        """Map, all blocks, robot arrow and trajectory, drawn for a model and for people."""
        return self.draw([block.number for block in self.everywhere], ())

    def block(self, number: int) -> Block:
        """The block with this number."""
        here = next((block for block in self.blocks if block.number == number), None)
        return here or next(block for block in self.everywhere if block.number == number)


@dataclass(frozen=True)
class BlockChoice:
    """Choice of the block to visit next.

    Attributes:
        number: Number of the chosen block; None if no block is worth a visit.
        reason: Reason for the choice in words, for the trace.
    """

    number: int | None
    reason: str
