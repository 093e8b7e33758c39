"""What a surface to stand on answers, and which part of a building is the main one.

The main part of a building is the one that a search is for: where things stand, or under a ceiling.
A roof may be larger than the floor below it, and so may a loft or a terrain. None of them has a
building's things on it, and a roof has nothing overhead. A scan that is cut open from above has no
ceilings, but things; a model without names has ceilings, but no things; so both are looked at.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Bool, Float, Float64

from hypernav.core.world import Instance, Position, Walkable

_MESH_ERROR_M = 0.25
"""Height of a mesh above its floor: a voxel, and some more."""
_UNEVEN_M = 1.0
"""How far floors of one storey are apart in height."""
BESIDE_M = 0.5
"""Distance from a thing's box within which the floor that it stands on begins."""
_BELOW_M, _ABOVE_M = 0.15, 0.5
"""How far a thing's lowest point may be below and above the floor that it stands on."""
_FEW = 4
"""A part with less than one in so many of the things that another has isn't the main one; where no
part has so many, things prove nothing."""
_ROOM_M2 = 2.0
"""Smaller parts are the insides of furniture and of chimneys, which are covered, too."""


def is_near_box(
    points: Float64[np.ndarray, "n 2"],
    low: tuple[float, float],
    high: tuple[float, float],
    reach_m: float,
) -> Bool[np.ndarray, "n"]:
    """Whether points are within a distance of a box, seen from above.

    Args:
        points: Positions, metres.
        low: Lowest corner of the box.
        high: Its highest corner.
        reach_m: Greatest distance to the box.
    """
    gaps = np.maximum(np.maximum(np.array(low) - points, points - np.array(high)), 0.0)
    return (gaps**2).sum(axis=1) <= reach_m**2


def floors_of_box(floor_z: Float64[np.ndarray, " n"], low_z: float) -> Bool[np.ndarray, " n"]:
    """Whether floors around a thing are those of its storey: of the highest one below it.

    Without this a thing would count as reached on the gallery over it, or under the stairwell in
    which it hangs.

    Args:
        floor_z: Heights of the floors around the thing, metres.
        low_z: Height of the thing's lowest point, metres.
    """
    below = floor_z <= low_z + _MESH_ERROR_M
    return below & (floor_z >= floor_z[below].max(initial=-np.inf) - _UNEVEN_M)


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


@runtime_checkable
class PathField(Protocol):
    """Shortest paths to the nearest of a set of goals. Scene frame, metres."""

    def distance(self, x: float, y: float, z: float | None = None) -> float:
        """Geodesic distance; infinite if no path leads there."""
        ...

    def path(self, x: float, y: float, z: float | None = None) -> list[tuple[float, float]]:
        """The path over all bends to the nearest goal, seen from above; empty if there is none."""
        ...


@runtime_checkable
class WalkableSurface(Walkable, Protocol):
    """A surface to stand on, of one storey or several: a grid of cells, or a navigation mesh."""

    def is_on_storey(self, z: Float64[np.ndarray, "n"]) -> Bool[np.ndarray, "n"]:
        """Whether heights belong to a storey of this surface."""
        ...

    def floor_near(
        self, low: Position, high: Position, reach_m: float
    ) -> Float64[np.ndarray, "n 3"]:
        """Positions on the largest part, a few centimetres apart, around a box on its storey."""
        ...

    def goal_field(self, goals: Float64[np.ndarray, "n 3"]) -> PathField:
        """Shortest paths to the nearest of these positions; those off the surface don't count."""
        ...
