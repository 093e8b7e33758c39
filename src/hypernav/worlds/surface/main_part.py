"""Which of several parts of a building a search is for: where things stand, or under a ceiling.

A roof may be larger than the floor below it, and so may a loft or a terrain. None of them has a
building's things on it, and a roof has nothing overhead. A scan that is cut open from above has no
ceilings, but things; a model without names has ceilings, but no things; so both are looked at.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Float64

from hypernav.core.world import Instance
from hypernav.worlds.surface.box_distance import is_near_box

BESIDE_M = 0.5
"""Distance from a thing's box within which the floor that it stands on begins."""
_BELOW_M, _ABOVE_M = 0.15, 0.5
"""How far a thing's lowest point may be below and above the floor that it stands on."""
_FEW = 4
"""A part with less than one in so many of the things that another has isn't the main one; where no
part has so many, things prove nothing."""
_ROOM_M2 = 2.0
"""Smaller parts are the insides of furniture and of chimneys, which are covered, too."""


@dataclass(frozen=True)
class FloorPart:
    """A connected part of where the robot can stand.

    Attributes:
        things: Number of labelled things that stand on it.
        covered: Share of it with something overhead, 0 to 1.
        is_below_top: Whether the scene goes on higher than a robot that stands there.
        area_m2: Its area, square metres.
    """

    things: int
    covered: float
    is_below_top: bool
    area_m2: float


def by_importance(parts: Sequence[FloorPart]) -> list[int]:
    """Indices of the parts, the main one first: with room, things, a ceiling, the largest."""
    most = max((part.things for part in parts), default=0)

    def key(k: int) -> tuple[bool, bool, bool, bool, float]:
        part = parts[k]
        has_room, has_things = part.area_m2 >= _ROOM_M2, part.things >= most // _FEW
        return has_room, has_things, is_covered(part), part.is_below_top, part.area_m2

    return sorted(range(len(parts)), key=key, reverse=True)


def is_covered(part: FloorPart) -> bool:
    """Whether one stands under something on most of a part."""
    return part.covered >= 0.5


def is_lived_on(part: FloorPart, most_things: int) -> bool:
    """Whether a part is a floor of the building: covered, or with many of its things."""
    return is_covered(part) or (part.things > 0 and part.things >= most_things // _FEW)


def stands_at(instance: Instance, z: Float[np.ndarray, "*n"]) -> Bool[np.ndarray, "*n"]:
    """Whether a thing's lowest point fits floors of these heights, metres."""
    low = instance.box_min[2]
    return (z >= low - _ABOVE_M) & (z <= low + _BELOW_M)


def things_on(points: Float64[np.ndarray, "n 3"], instances: Iterable[Instance]) -> int:
    """Number of labelled things that stand on a floor of these points, scene frame, metres."""
    return sum(
        bool(
            (
                is_near_box(points[:, :2], one.box_min[:2], one.box_max[:2], BESIDE_M)
                & stands_at(one, points[:, 2])
            ).any()
        )
        for one in instances
        if one.label is not None
    )
