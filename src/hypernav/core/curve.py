"""Curves through a few points, as values of a configuration."""

import itertools
from typing import Annotated

import numpy as np
from pydantic import AfterValidator, Field

_Number = Annotated[float, Field(ge=-1000.0, le=1000.0)]


def _rising(points: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
    if any(before >= after for (before, _), (after, _) in itertools.pairwise(points)):
        raise ValueError("the first numbers of the points must rise")
    return points


Curve = Annotated[
    tuple[tuple[_Number, _Number], ...], Field(max_length=1000), AfterValidator(_rising)
]
"""Points ``(x, y)`` in rising order: linear between them, level beyond the first and last."""


def along(curve: Curve, x: float) -> float:
    """The y of a curve at x.

    Args:
        curve: At least one point.
        x: Where.
    """
    return float(np.interp(x, [point[0] for point in curve], [point[1] for point in curve]))
