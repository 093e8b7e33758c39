"""What looks like a box or a point in an answer, as it was written."""

import math
import re
from dataclasses import dataclass
from typing import Any

from hypernav.models.chat.answer_parsing import writable

MOST_ITEMS = 200
"""Number of items of an answer that are looked at."""
NUMBER = r"[-+]?(?:\d{1,20}(?:\.\d{0,20})?|\.\d{1,20})(?:[eE][-+]?\d{1,4})?"
"""A number."""


@dataclass(frozen=True)
class Item:
    """Something that looks like a box or a point: its numbers as they were written.

    Attributes:
        numbers: They are four of a box, two of a point.
        label: Label; empty if there is none.
        score: Score; 1 if there is none.
        rows_first: Whether rows come first; None for the family's order.
        form: Order of a box's numbers, one of `_FORMS`; empty if nothing says it.
        key: The key above, where none tells of a box or a point.
        is_denied: Whether it is said to be absent.
        side: The image's sides in the unit of the numbers; None for the family's.
        is_point: Whether it is a point.
    """

    numbers: Any
    label: str = ""
    score: float = 1.0
    rows_first: bool | None = None
    form: str = ""
    key: str = ""
    is_denied: bool = False
    side: float | None = None
    is_point: bool = False


def number_of(value: Any) -> float:
    """The value as a number; NaN if it is none."""
    if isinstance(value, str) and re.fullmatch(NUMBER, value.strip()):
        return float(value)
    if isinstance(value, bool) or not isinstance(value, int | float):
        return math.nan
    try:
        return float(value)
    except OverflowError:
        return math.inf


def in_groups(numbers: list[str], size: int) -> list[list[str]]:
    """The numbers in groups; all in one, which is rejected, if they don't come out even."""
    if len(numbers) % size:
        return [numbers]
    return [numbers[k : k + size] for k in range(0, len(numbers), size)]


def one_line(label: str) -> str:
    """A label as one line of at most 80 characters."""
    return " ".join(writable(label).split())[:80]


def enclosing(outline: Any) -> list[float] | None:
    """The box around the corners of an outline: pairs, or objects with x and y; None if it is none.

    All coordinates are x first, as their keys say; a bare pair is taken alike.
    """
    if not isinstance(outline, list) or len(outline) < 2:
        return None
    pairs = [[one.get("x"), one.get("y")] if isinstance(one, dict) else one for one in outline]
    if not all(isinstance(pair, list) and len(pair) == 2 for pair in pairs):
        return None
    xs, ys = ([number_of(pair[k]) for pair in pairs] for k in (0, 1))
    if not all(map(math.isfinite, [*xs, *ys])):
        return None
    return [min(xs), min(ys), max(xs), max(ys)]
