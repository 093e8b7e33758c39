"""Positions of the names of things, so that all are readable."""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

_ROWS = (0.0, -1.0, 1.0, -2.0, 2.0)
_SAME_NAME_ROWS = 6.0


class Label(NamedTuple):
    """A name and the position of its middle in an image, pixels.

    Attributes:
        text: The name.
        u: Column.
        v: Row.
        width: Width of the written name.
    """

    text: str
    u: float
    v: float
    width: float


def placed_labels(labels: Sequence[Label], height: float) -> list[Label]:
    """Labels where none covers another, moved by at most two rows.

    Earlier labels have priority. A label without room is left out, and so is one near another label
    of the same name: three kitchen cabinets in a row need only one.

    Args:
        labels: Labels where the things are.
        height: Height of a row, pixels.
    """
    placed: list[Label] = []
    for label in labels:
        if any(_says_the_same(label, other, height) for other in placed):
            continue
        placed += free_labels(moved_by_rows(label, height), placed, height)[:1]
    return placed


def moved_by_rows(label: Label, height: float) -> list[Label]:
    """A label where it is, and moved by one or two rows."""
    return [label._replace(v=label.v + row * height) for row in _ROWS]


def free_labels(labels: Iterable[Label], placed: Sequence[Label], height: float) -> list[Label]:
    """The labels that cover none of those placed."""
    return [one for one in labels if not _covers_any(one, placed, height)]


def _says_the_same(label: Label, other: Label, height: float) -> bool:
    near = math.hypot(label.u - other.u, label.v - other.v) < _SAME_NAME_ROWS * height
    return label.text == other.text and near


def _covers_any(label: Label, others: Sequence[Label], height: float) -> bool:
    return any(
        abs(label.u - other.u) < (label.width + other.width) / 2.0
        and abs(label.v - other.v) < height
        for other in others
    )
