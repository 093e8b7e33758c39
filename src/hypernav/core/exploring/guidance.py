"""Guidance by a direction in the camera image: left, right, straight on, or explore elsewhere."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property

import numpy as np
from jaxtyping import UInt8

from hypernav.core.observation import Observation


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
