"""What stands in which kind of room (``room_kinds.yaml``), and what a view tells by it."""

from dataclasses import dataclass
from functools import cache
from importlib.resources import files

import numpy as np
from jaxtyping import Float64

from hypernav.core.errors import LabelsMissingError
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel, canonical, normalise
from hypernav.core.observation import Observation
from hypernav.io.parsing import parse_yaml

_CHANCES = {"always": 0.85, "often": 0.5, "sometimes": 0.2, "rarely": 0.05}
"""Chances that a room of a kind holds a thing that the kind lists; ours."""
_NEVER = 0.01
"""The same for a thing that only other kinds list: nothing is impossible."""
_STRIDE = 8
"""Every 8th pixel in both directions is read."""
_LEAST_PIXELS = 2
"""Number of these pixels from which a thing counts as in view."""


@dataclass(frozen=True, eq=False)
class RoomTable:
    """What stands in which kind of room.

    Attributes:
        kinds: Names of the kinds of rooms; all arrays follow their order.
        chances: Chances that a room of each kind holds a thing, by the thing's canonical name.
        numbers: Numbers of the kinds by their names and other names.
    """

    kinds: tuple[str, ...]
    chances: dict[str, Float64[np.ndarray, "kinds"]]
    numbers: dict[str, int]

    def of_thing(self, name: str) -> str | None:
        """The name in the table that a thing's name ends with: "sofa" for "L-shaped sofa".

        Returns:
            The longest such name; None if the table knows none.
        """
        return next((one for one in _endings(name) if one in self.chances), None)


def _endings(name: str) -> list[str]:
    words = normalise(name).split()
    return [canonical(" ".join(words[first:])) for first in range(len(words))]


@cache
def room_table() -> RoomTable:
    """The table that comes with this package."""
    text = files("hypernav.search.rivals").joinpath("room_kinds.yaml").read_text("utf-8")
    entries: dict[str, dict[str, str]] = parse_yaml(text)
    kinds = tuple(entries)
    chances: dict[str, Float64[np.ndarray, " kinds"]] = {}
    numbers: dict[str, int] = {}
    for number, (kind, entry) in enumerate(entries.items()):
        for name in (kind, *_listed(entry.get("names", ""))):
            numbers[canonical(name)] = number
        for grade, chance in _CHANCES.items():
            for name in _listed(entry.get(grade, "")):
                of_name = chances.setdefault(canonical(name), np.full(len(kinds), _NEVER))
                of_name[number] = max(of_name[number], chance)
    return RoomTable(kinds=kinds, chances=chances, numbers=numbers)


def _listed(text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]


def chance_in_view(
    observation: Observation, goal: Goal, columns: slice = slice(None)
) -> float | None:
    """Chance that a room like the one in view holds the goal; 1 where the goal is in view.

    Args:
        observation: Present frame.
        goal: Goal of the search.
        columns: Columns of the image that count; all by default.

    Returns:
        0 to 1; None where nothing that tells a room is in view, or the table doesn't know the goal.

    Raises:
        LabelsMissingError: The world supplies no labels.
    """
    truth = observation.truth
    if truth is None:
        raise LabelsMissingError(
            "scoring views by the truth needs a simulated world with labels, and this one supplies "
            "none; choose a real model, for example --reasoner similarity:PATH_OR_ID"
        )
    ids = truth.ids[::_STRIDE, columns][:, ::_STRIDE]
    pixels = np.bincount(ids[ids >= 0])
    shown = {
        truth.labels[number]: int(pixels[number])
        for number in np.flatnonzero(pixels >= _LEAST_PIXELS).tolist()
        if number in truth.labels
    }
    if any(label.satisfies(goal) for label in shown):
        return 1.0
    table = room_table()
    thing = table.of_thing(goal.text)
    rooms = _rooms_in_view(table, shown)
    return None if thing is None or rooms is None else float(rooms @ table.chances[thing])


def average_chance(goal: Goal) -> float:
    """Chance that an average room holds the goal; 0.5 if the table doesn't know it."""
    thing = room_table().of_thing(goal.text)
    return 0.5 if thing is None else float(room_table().chances[thing].mean())


def _rooms_in_view(
    table: RoomTable, shown: dict[ObjectLabel, int]
) -> Float64[np.ndarray, " kinds"] | None:
    """Probability of each kind of room, by the things in view; None if these tell nothing."""
    rooms = np.zeros(len(table.kinds))
    for label, pixels in shown.items():
        number = table.numbers.get(canonical(label.room)) if label.room else None
        if number is not None:
            rooms[number] += pixels
    if not rooms.any():
        things = sorted({name for one in shown if (name := table.of_thing(one.category))})
        if not things:
            return None
        rooms = np.exp(sum(np.log(table.chances[thing]) for thing in things))
    return rooms / rooms.sum()
