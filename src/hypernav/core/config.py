"""Configuration: frozen models with bounds, and curves as their values."""

import inspect
import itertools
import re
from functools import cache
from numbers import Integral, Real
from typing import Annotated, ClassVar

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from hypernav.core.errors import ConfigError

MOST_STEPS = 1_000_000
"""The longest search, and the upper bound of all numbers of steps."""
MOST_THREADS = 256
MOST_SEED = 2**63 - 1
"""The largest seed that chat servers accept."""

UNITS = {"_m": "m", "_m2": "m²", "_px": "px", "_deg": "°", "_s": "s", "_steps": "steps"}
"""Units by the endings of field names."""
_MEANING = re.compile(r"^ {4}(\w+): (.*(?:\n {8}.*)*)", re.MULTILINE)

_Number = Annotated[float, Field(ge=-1000.0, le=1000.0)]


class RoomConfig(BaseModel):
    """Base of every room's configuration: frozen; unknown keys, NaN and infinity are errors.

    Every number has a lower and an upper bound, so that no configuration exhausts memory or time.
    """

    model_config: ClassVar[ConfigDict] = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False
    )


@cache
def meanings(model: type[BaseModel]) -> dict[str, str]:
    """What each field means, by its name: the entries under "Attributes" of the docstring."""
    entries = _MEANING.findall(inspect.cleandoc(model.__doc__ or ""))
    return {name: " ".join(words.split()) for name, words in entries if name in model.model_fields}


def check_option(name: str, value: float, bounds: tuple[float, float], what: str) -> None:
    """Refuse a value that is out of bounds or not a number.

    Args:
        name: Name of the option, or of the argument.
        value: Its value.
        bounds: The smallest and the largest value; whole numbers for a whole number.
        what: What the number is, such as "metres", for the message.

    Raises:
        ConfigError: The value is out of bounds, or not a number.
    """
    low, high = bounds
    kind = Integral if isinstance(low, int) else Real
    if not isinstance(value, kind) or isinstance(value, bool) or not low <= value <= high:
        raise ConfigError(f"{name} {value!r:.20}: {what}; expected {low:,} to {high:,}")


def _rising(points: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
    if any(before >= after for (before, _), (after, _) in itertools.pairwise(points)):
        raise ValueError("the first numbers of the points must rise")
    if any(before > after for (_, before), (_, after) in itertools.pairwise(points)):
        raise ValueError("the second numbers of the points must not fall")
    return points


def _of_probabilities(points: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
    if any(not 0.0 <= value <= 1.0 for point in points for value in point):
        raise ValueError("all numbers of the points must be probabilities, 0 to 1")
    return points


Curve = Annotated[
    tuple[tuple[_Number, _Number], ...], Field(max_length=1000), AfterValidator(_rising)
]
"""Points ``(x, y)`` in rising order: linear between them, level beyond the first and last. What
more of x is worth never is less."""
ProbabilityCurve = Annotated[Curve, AfterValidator(_of_probabilities)]
"""A curve from told to true probabilities."""


def along(curve: Curve, x: float) -> float:
    """The y of a curve at x.

    Args:
        curve: At least one point.
        x: Where.
    """
    return float(np.interp(x, [point[0] for point in curve], [point[1] for point in curve]))
