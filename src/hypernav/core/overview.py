"""The map as a question: numbered blocks, the image of them, and the answer."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from jaxtyping import UInt8

from hypernav.core.geometry.transforms import Pose2


@dataclass(frozen=True)
class Block:
    """A labelled square of the explored map, the unit of a global answer.

    Attributes:
        number: The label, from 1.
        x_min: Lower left corner in the ``map`` frame, metres.
        y_min: Lower left corner in the ``map`` frame, metres.
        size_m: Side length.
        free_cells: Cells in it where the robot may be.
        frontier_cells: Free cells in it that touch the unknown.
        destination: Where the robot would go in it: the middle of a free cell, metres.
        travel_m: Length of the way there over the known map, metres; infinite if there is none.
    """

    number: int
    x_min: float
    y_min: float
    size_m: float
    free_cells: int
    frontier_cells: int
    destination: tuple[float, float]
    travel_m: float


@dataclass(frozen=True, eq=False)
class Overview:
    """What a reasoner may know when it chooses a block.

    Attributes:
        draw: Makes the image, which not every reasoner looks at.
        blocks: In order of their numbers.
        robot: Where the robot is, ``map`` frame.
    """

    draw: Callable[[], UInt8[np.ndarray, "height width 3"]]
    blocks: tuple[Block, ...]
    robot: Pose2

    @cached_property
    def image(self) -> UInt8[np.ndarray, "height width 3"]:
        """Map, numbered blocks, robot arrow and trajectory, drawn for a model and for people."""
        return self.draw()

    def block(self, number: int) -> Block:
        """The block with this number."""
        return next(block for block in self.blocks if block.number == number)


@dataclass(frozen=True)
class BlockChoice:
    """Where a reasoner would look next.

    Attributes:
        number: The chosen block; None if it finds none worth visiting.
        reason: In words, for the trace.
        probabilities: How likely each block was, where the reasoner can say.
    """

    number: int | None
    reason: str
    probabilities: dict[int, float] = field(default_factory=dict)
