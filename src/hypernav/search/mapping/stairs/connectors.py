"""Connectors between the floors of a building, stairs or ramps: what a robot knows of them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

from hypernav.core.geometry.transforms import wrap_angle

_SAME_M = 1.0
"""Distance between the ends of two sightings of one connector, metres."""
_SAME_REFUTED_M = 0.5
"""The same for a connector that was refuted: the true head of stairs may be beside a railing."""
_SAME_AXIS = 0.35
"""Greatest difference between the directions of two sightings of one edge, radians."""
_STAYED_M = 1.0
"""Greatest length of the last action of a search, up or down stairs, metres."""
_SIGHTINGS = 2
"""Images that must show a connector before the robot relies on it."""
MOST_CONNECTORS = 1000
"""Number of connectors in a building; once half are known, only those driven over are added."""


class Passage(StrEnum):
    """What the robot knows of the path over a connector."""

    UNTRIED = "untried"
    USED = "used"
    REFUTED = "refuted"
    """There is no path, or what was seen are no stairs."""


@dataclass(frozen=True)
class Connector:
    """Stairs or a ramp, as seen from one of the two floors that they connect.

    Attributes:
        floor: Number of the floor that it is seen from.
        goes_up: Whether it leads up from there.
        end: Its end on this floor: position ``(x, y)`` in the middle of the first edge, metres.
        axis: Direction in which it leads away from there, radians.
        passage: What is known of the path.
        other_floor: Number of the floor at its other end; None if it is not known.
        sightings: Number of images that showed it, since one showed that no stairs begin there.
    """

    floor: int
    goes_up: bool
    end: tuple[float, float]
    axis: float
    passage: Passage = Passage.UNTRIED
    other_floor: int | None = None
    sightings: int = 1

    @property
    def is_usable(self) -> bool:
        """Whether the robot may rely on it."""
        return self.passage is not Passage.REFUTED and self.sightings >= _SIGHTINGS

    @property
    def is_doubtful(self) -> bool:
        """Whether it was seen too seldom to rely on, and nobody has tried it."""
        return self.passage is Passage.UNTRIED and 0 < self.sightings < _SIGHTINGS

    @property
    def is_new(self) -> bool:
        """Whether nobody knows where it leads."""
        return self.is_usable and self.other_floor is None

    @property
    def approach(self) -> tuple[float, float]:
        """Position ``(x, y)`` on the floor, right before the stairs, metres."""
        x, y = self.end
        return (x - 0.3 * math.cos(self.axis), y - 0.3 * math.sin(self.axis))

    @property
    def beyond(self) -> tuple[float, float]:
        """Position ``(x, y)`` on the stairs, metres."""
        x, y = self.end
        return (x + math.cos(self.axis), y + math.sin(self.axis))

    @property
    def words(self) -> str:
        """Name for models and people."""
        return "stairs up" if self.goes_up else "stairs down"

    def is_same(self, other: "Connector") -> bool:
        """Whether another sighting is of this connector."""
        same_m = _SAME_REFUTED_M if self.passage is Passage.REFUTED else _SAME_M
        return (
            self.floor == other.floor
            and self.goes_up == other.goes_up
            and math.dist(self.end, other.end) <= same_m
        )

    def leads_along(self, other: "Connector") -> bool:
        """Whether it leads in about the same direction as another."""
        return abs(wrap_angle(self.axis - other.axis)) <= _SAME_AXIS


@dataclass(frozen=True)
class UnderWay:
    """A robot on its way over a connector, where a search may end and the next one begin.

    Attributes:
        connector: Number of the connector.
        position: Where it was before its latest action ``(x, y, z)``, ``map`` frame, metres.
    """

    connector: int
    position: tuple[float, float, float]

    def is_at(self, position: tuple[float, float, float]) -> bool:
        """Whether a robot that begins a search there has stayed where the last one ended."""
        return math.dist(self.position, position) <= _STAYED_M


def with_sightings(known: Sequence[Connector], seen: Sequence[Connector]) -> tuple[Connector, ...]:
    """The known connectors with those of one more image; numbers, their indices, stay."""
    connectors = list(known)
    for one in seen:
        number = next((k for k, old in enumerate(connectors) if old.is_same(one)), None)
        if number is None:
            connectors += [one] if len(connectors) < MOST_CONNECTORS // 2 else []
            continue
        old = connectors[number]
        is_untried = old.passage is Passage.UNTRIED
        now = replace(old, end=one.end, axis=_mean_axis(old, one)) if is_untried else old
        connectors[number] = replace(now, sightings=old.sightings + 1)
    return tuple(connectors)


def _mean_axis(known: Connector, seen: Connector) -> float:
    """The axis of a known connector with one more sighting; the new one if they do not agree."""
    if not known.leads_along(seen):
        return seen.axis
    turned = wrap_angle(seen.axis - known.axis)
    return wrap_angle(known.axis + turned / (known.sightings + 1))


def relied_on(
    known: Sequence[Connector], stairs: Connector
) -> tuple[tuple[Connector, ...], int | None]:
    """The known connectors with stairs that the robot is on, and their number.

    It may rely on them, however seldom they were seen. No number is given for what it has tried.
    """
    number = next((k for k, one in enumerate(known) if one.is_same(stairs)), len(known))
    there = known[number] if number < len(known) else stairs
    there = replace(there, sightings=max(there.sightings, _SIGHTINGS))
    if not there.is_new:
        return tuple(known), None
    return (*known[:number], there, *known[number + 1 :]), number


def with_crossing(
    known: Sequence[Connector],
    number: int,
    floor: int,
    end: tuple[float, float],
    axis: float,
) -> tuple[Connector, ...]:
    """The known connectors after one of them was taken; it is known from both ends then.

    Args:
        known: The connectors.
        number: Number of the one that was taken.
        floor: Number of the floor that it led to.
        end: Where the robot came to that floor ``(x, y)``, metres.
        axis: Direction back from there, radians.
    """
    connectors = list(known)
    there = connectors[number]
    connectors[number] = replace(there, passage=Passage.USED, other_floor=floor)
    back = Connector(floor, not there.goes_up, end, axis, sightings=_SIGHTINGS)
    same = next((k for k, one in enumerate(connectors) if one.is_same(back)), len(connectors))
    seen = connectors[same] if same < len(connectors) else back
    connectors[same : same + 1] = [
        replace(seen, passage=Passage.USED, other_floor=there.floor, sightings=_SIGHTINGS)
    ]
    return tuple(connectors)
