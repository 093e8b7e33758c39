"""Guidance in the camera image: numbered arrows to choose from, or directions in words."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property

import numpy as np
from jaxtyping import UInt8

from hypernav.core.observation import Observation

TURN_AROUND = 0
"""The number that stands for turning around, where that answer is allowed."""


@dataclass(frozen=True)
class Arrow:
    """A move straight ahead in some direction, the unit of an answer about the camera image.

    Attributes:
        number: Number on the image, from 1.
        heading: Direction from the robot's heading, radians, positive to the left.
        length_m: Length of the move, metres.
        end: Position ``(x, y)`` of its end, ``map`` frame, metres.
        pixel: Image coordinates ``(u, v)`` of its mark.
        free_m: Length of the free floor in that direction by the depth image, metres.
        is_explored: Whether the robot has looked there before.
    """

    number: int
    heading: float
    length_m: float
    end: tuple[float, float]
    pixel: tuple[float, float]
    free_m: float
    is_explored: bool


@dataclass(frozen=True, eq=False)
class ArrowView:
    """Everything that a reasoner may know when it chooses an arrow.

    Attributes:
        draw: Function that draws the arrows into the camera image; not every reasoner calls it.
        arrows: Arrows in the order of their numbers.
        may_turn: Whether `TURN_AROUND` may be answered.
        wanted: Number of arrows to name at most, the best first.
        asked: Number of questions in this search before this one.
        facts: Sentences about things seen before.
    """

    draw: Callable[[], UInt8[np.ndarray, "height width 3"]]
    arrows: tuple[Arrow, ...]
    may_turn: bool
    wanted: int = 1
    asked: int = 0
    facts: tuple[str, ...] = ()

    @cached_property
    def image(self) -> UInt8[np.ndarray, "height width 3"]:
        """The camera image with all arrows and their numbers."""
        return self.draw()

    def arrow(self, number: int) -> Arrow:
        """The arrow with this number."""
        return next(arrow for arrow in self.arrows if arrow.number == number)


@dataclass(frozen=True)
class ArrowChoice:
    """Choice of the next move.

    Attributes:
        numbers: Numbers of the chosen arrows, the best first, or `TURN_AROUND` alone; empty if the
            answer names none.
        reason: Reason for the choice in words, for the trace.
    """

    numbers: tuple[int, ...]
    reason: str


class Direction(StrEnum):
    """Directions in an image that may lead to the goal."""

    LEFT = "left"
    RIGHT = "right"
    STRAIGHT = "straight"
    EXPLORE = "explore more"
    """Nothing in the image leads to the goal."""


@dataclass(frozen=True, eq=False)
class GuideView:
    """Everything that a guide may know when it says a direction.

    Attributes:
        observation: Present frame.
        windows: Columns of the image that each direction but `Direction.EXPLORE` stands for.
        draw_past: Function that draws the image of the previous choice beside the map with the path
            since then; None at the first choice.
    """

    observation: Observation
    windows: dict[Direction, slice]
    draw_past: Callable[[], UInt8[np.ndarray, "height width 3"]] | None = None

    @cached_property
    def images(self) -> tuple[UInt8[np.ndarray, "_ _ 3"], ...]:
        """The camera image and, after the first choice, the image of the past."""
        past = () if self.draw_past is None else (self.draw_past(),)
        return (self.observation.rgb, *past)


@dataclass(frozen=True)
class GuideChoice:
    """A direction, and the reason for it in words, for the trace."""

    direction: Direction
    reason: str
