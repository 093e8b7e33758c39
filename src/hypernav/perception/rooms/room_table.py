"""The table of what stands in which kind of room (``room_kinds.yaml``), and look-ups in it."""

import re
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

import numpy as np
from jaxtyping import Float64

from hypernav.core.files.yaml_text import parse_yaml
from hypernav.core.goal import Goal
from hypernav.core.labels import canonical, normalise

_CHANCES = {"always": 0.85, "often": 0.5, "sometimes": 0.2, "rarely": 0.05}
"""Chances that a room of a kind holds one of what it names; ours."""
_NEVER = 0.01
"""The same of things that only other kinds name: nothing is impossible."""
_AREAS_M2 = (4.0, 40.0)
"""Bounds of a room's floor: in a hall not all of it hides a thing equally well."""
_WEIGHT = re.compile(r"^(.*?)(?: (\d+))?$")


@dataclass(frozen=True, eq=False)
class RoomTable:
    """What stands in which kind of room, and which rooms lie beside each other.

    Attributes:
        kinds: Names of the kinds of rooms; all arrays follow their order.
        chances: Chances that a room of each kind holds a thing, by the thing's canonical name.
        beside: Probabilities of the kinds of rooms beside one of the row's kind; rows sum up to 1.
        areas_m2: Floor of a usual room, square metres.
        numbers: Numbers of the kinds by their names and other names.
    """

    kinds: tuple[str, ...]
    chances: dict[str, Float64[np.ndarray, "kinds"]]
    beside: Float64[np.ndarray, "kinds kinds"]
    areas_m2: Float64[np.ndarray, "kinds"]
    numbers: dict[str, int]

    def of_thing(self, name: str) -> str | None:
        """The name in the table that a name ends with: "L-shaped sofa" is a sofa.

        Returns:
            The longest such name; None if the table knows none, so that the thing tells nothing.
        """
        return next((one for one in _endings(name) if one in self.chances), None)

    def densities(self, goal: Goal) -> Float64[np.ndarray, "kinds"] | None:
        """How likely a square metre of each kind of room holds the goal; 1 on average.

        Returns:
            None if the table knows neither the thing nor a room that the goal names at its end.
        """
        thing = self.of_thing(goal.text)
        if thing is not None:
            chances = self.chances[thing]
        else:
            room = next((one for one in _endings(goal.text) if one in self.numbers), None)
            if room is None:
                return None
            chances = np.full(len(self.kinds), _NEVER)
            chances[self.numbers[room]] = _CHANCES["always"]
        densities = chances / self.areas_m2
        return densities / densities.mean()


def _endings(name: str) -> list[str]:
    words = normalise(name).split()
    return [canonical(" ".join(words[first:])) for first in range(len(words))]


@cache
def room_table() -> RoomTable:
    """The table that comes with this package."""
    text = files("hypernav.perception.rooms").joinpath("room_kinds.yaml").read_text("utf-8")
    entries: dict[str, dict[str, str]] = parse_yaml(text)
    kinds = tuple(entries)
    chances: dict[str, Float64[np.ndarray, " kinds"]] = {}
    numbers: dict[str, int] = {}
    beside = np.zeros((len(kinds), len(kinds)))
    for number, (kind, entry) in enumerate(entries.items()):
        for name in (kind, *_listed(entry.get("names", ""))):
            numbers[canonical(name)] = number
        for grade, chance in _CHANCES.items():
            for name in _listed(entry.get(grade, "")):
                of_name = chances.setdefault(canonical(name), np.full(len(kinds), _NEVER))
                of_name[number] = max(of_name[number], chance)
        for other, weight in (_weighed(name) for name in _listed(entry["beside"])):
            beside[number, kinds.index(other)] = weight
    return RoomTable(
        kinds=kinds,
        chances=chances,
        beside=beside / beside.sum(axis=1, keepdims=True),
        areas_m2=np.clip([float(one["area_m2"]) for one in entries.values()], *_AREAS_M2),
        numbers=numbers,
    )


def _listed(text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]


def _weighed(text: str) -> tuple[str, float]:
    """Name and weight of "hall 3"; without a number the weight is 1."""
    match = _WEIGHT.match(text)
    assert match is not None  # it matches every text
    return match[1], float(match[2] or 1)
