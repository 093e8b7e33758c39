"""The table of what stands in which kind of room (``room_kinds.yaml``), and look-ups in it."""

from dataclasses import dataclass
from functools import cache
from importlib.resources import files

import numpy as np
from jaxtyping import Float64

from hypernav.core.naming.labels import canonical, normalise
from hypernav.io.parsing import parse_yaml

_CHANCES = {"always": 0.85, "often": 0.5, "sometimes": 0.2, "rarely": 0.05}
"""Chances that a room of a kind holds a thing that the kind lists; ours."""
_NEVER = 0.01
"""The same for a thing that only other kinds list: nothing is impossible."""


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
