"""Connectors between the floors of a building: stairs and ramps, seen without training.

Stairs are told from furniture by what they are for: a robot that takes their steps could walk on
them from the floor to far above or below it. Stairs down are mostly out of a level camera's sight.
They are told by an open edge of the floor, wide enough for the robot, beyond which the camera sees
below the floor.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import cv2
import numpy as np
from jaxtyping import Bool

from hypernav.core.geometry.transforms import wrap_angle
from hypernav.mapping.config import STAIRS_M
from hypernav.mapping.ground import Ground, closed

LEVEL_M = 0.08
"""Greatest height above or below a floor, metres, that belongs to it: rugs and sills do."""
_LEAST_M2 = 0.1
"""Ground that far from the floor's height, within the robot's reach, square metres."""
_HIGH_M = 0.65
"""Height, metres, to which steps are seen at least that count without the first one."""
_UNSEEN_M = 0.6
"""Greatest length of steps up before those that are seen, metres: two treads."""
_DROP_M2 = 0.25
"""Presumed stairs down, within the robot's reach, square metres."""
_ALONG_M = 1.0
"""Length of the stairs from their end, metres, that tells their direction."""
_SAME_M = 1.0
"""Distance between the ends of two sightings of one connector, metres."""
_SAME_REFUTED_M = 0.5
"""The same for a connector that was refuted: the true head of stairs may be beside a railing."""
_WHOLE_M = 1.0
"""Distance from which the edge of a floor is seen whole, metres."""
_SAME_AXIS = 0.35
"""Greatest difference between the directions of two sightings of one edge, radians."""
_SPECK_CELLS = 10
_GAP_CELLS = 5
"""Width of a gap between steps, cells, from which it parts them."""
_STAYED_M = 1.0
"""Greatest length of the last action of a search, up or down stairs, metres."""
_SIGHTINGS = 2
"""Images that must show a connector before the robot relies on it."""


class Passage(StrEnum):
    """What the robot knows of the way over a connector."""

    UNTRIED = "untried"
    USED = "used"
    REFUTED = "refuted"
    """There is no way, or what was seen are no stairs."""


@dataclass(frozen=True)
class Connector:
    """Stairs or a ramp, as seen from one of the two floors that they connect.

    Attributes:
        floor: Number of the floor that it is seen from.
        goes_up: Whether it leads up from there.
        end: Its end on this floor: position ``(x, y)`` in the middle of the first edge, metres.
        axis: Direction in which it leads away from there, radians.
        passage: What is known of the way.
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


def reliable(
    seen: Sequence[Connector],
    known: Sequence[Connector],
    position: tuple[float, float],
    ground: Ground,
    floor_z: float,
) -> list[Connector]:
    """The sightings without those of edges of the floor that are too near to be seen whole.

    Of these a camera sees the ends only. They count if ground below the floor was seen
    near them, from farther away, or if they lead where a known connector does.

    Args:
        seen: The sightings.
        known: The known connectors.
        position: The robot ``(x, y)``, metres.
        ground: Ground around the robot.
        floor_z: Height of the floor, metres.
    """
    return [
        one
        for one in seen
        if one.goes_up
        or math.dist(one.end, position) >= _WHOLE_M
        or shows_steps(ground, one, floor_z)
        or any(
            one.is_same(other) and abs(wrap_angle(one.axis - other.axis)) <= _SAME_AXIS
            for other in known
        )
    ]


def shows_steps(ground: Ground, down: Connector, floor_z: float) -> bool:
    """Whether ground below the floor was seen near the end of stairs down."""
    with np.errstate(invalid="ignore"):
        below = ground.reached & ground.seen & (ground.measured <= floor_z - LEVEL_M)
    return ground.area_m2(below & (ground.distances_m(down.end) <= _ALONG_M)) >= _LEAST_M2


def with_sightings(known: Sequence[Connector], seen: Sequence[Connector]) -> tuple[Connector, ...]:
    """The known connectors with those of one more image; numbers, their indices, stay."""
    connectors = list(known)
    for one in seen:
        number = next((k for k, old in enumerate(connectors) if old.is_same(one)), None)
        if number is None:
            connectors.append(one)
            continue
        old = connectors[number]
        is_untried = old.passage is Passage.UNTRIED
        now = replace(old, end=one.end, axis=_mean_axis(old, one)) if is_untried else old
        connectors[number] = replace(now, sightings=old.sightings + 1)
    return tuple(connectors)


def _mean_axis(known: Connector, seen: Connector) -> float:
    """The axis of a known connector with one more sighting; the new one if they do not agree."""
    turned = wrap_angle(seen.axis - known.axis)
    if abs(turned) > _SAME_AXIS:
        return seen.axis
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


def connectors_in(ground: Ground, floor: int, floor_z: float) -> list[Connector]:
    """The connectors that begin within reach on a floor.

    Args:
        ground: Ground around the robot, which is on that floor; unseen steps down presumed.
        floor: Number of the floor.
        floor_z: Its height, metres.
    """
    reached, heights = ground.reached, ground.measured
    with np.errstate(invalid="ignore"):
        above = reached & ground.seen & (heights >= floor_z + LEVEL_M)
        below = reached & (ground.presumed | (ground.seen & (heights <= floor_z - LEVEL_M)))
        high, low = heights >= floor_z + STAIRS_M, ground.seen & (heights <= floor_z - STAIRS_M)
        if below.any():  # narrow unseen spots that lie lower part no steps
            lower = reached & ground.unseen.cells & (ground.heights <= floor_z - LEVEL_M)
            below |= lower & closed(below, _GAP_CELLS)
    found = list[Connector]()
    for part in _parts(above):
        if min(ground.area_m2(part & high), ground.area_m2(part & ~high)) >= _LEAST_M2:
            found += _connector(ground, part, floor, floor_z, goes_up=True)
    for part in _parts(below):
        presumed = part & ground.presumed
        if ground.area_m2(part & low) >= _LEAST_M2 or ground.area_m2(presumed) >= _DROP_M2:
            found += _connector(ground, part, floor, floor_z, goes_up=False)
    return found


def _connector(
    ground: Ground,
    part: Bool[np.ndarray, "rows columns"],
    floor: int,
    floor_z: float,
    *,
    goes_up: bool,
) -> list[Connector]:
    """The connector of a part of the ground; empty if it does not begin on the floor."""
    level = ground.between(floor_z - LEVEL_M, floor_z + LEVEL_M) & ~ground.presumed
    level = _joined(level, ground.seen)  # what is unseen beyond steps may be a part of the well
    edge = level & _grown(_first_step(ground, part, floor_z) if goes_up else part)
    if goes_up and not edge.any():
        high = part & (ground.heights >= floor_z + _HIGH_M)
        if ground.area_m2(high) >= _LEAST_M2:
            part = _with_unseen_steps(ground, part, floor_z)
            edge = level & _grown(_first_step(ground, part, floor_z))
    if not edge.any():
        return []
    points, steps = ground.positions(edge), ground.positions(part)
    end = points[ground.clearance_m[edge].argmax()]  # in the middle between railings
    away = steps[np.linalg.norm(steps - end, axis=1) <= _ALONG_M].mean(axis=0) - end
    beside = points[np.linalg.norm(points - end, axis=1) <= _ALONG_M / 2.0] - end
    along = np.linalg.svd(beside)[2][0]  # stairs lead away at right angles to their first edge
    ahead = away - (away @ along) * along
    axis = math.atan2(ahead[1], ahead[0])
    return [Connector(floor, goes_up, (float(end[0]), float(end[1])), axis)]


def _first_step(
    ground: Ground, part: Bool[np.ndarray, "rows columns"], floor_z: float
) -> Bool[np.ndarray, "rows columns"]:
    """The part of steps up that the robot can get onto from the floor: not their side."""
    return part & (ground.heights <= floor_z + STAIRS_M)


def _with_unseen_steps(
    ground: Ground, part: Bool[np.ndarray, "rows columns"], floor_z: float
) -> Bool[np.ndarray, "rows columns"]:
    """Steps up with those right before them that the camera does not see from so near."""
    side = 2 * math.ceil(_UNSEEN_M / ground.grid.resolution_m) + 1
    unseen = ground.reached & ~ground.seen & _grown(part, side)
    return _joined(part | (unseen & (ground.heights >= floor_z + LEVEL_M)), part)


def _joined(
    mask: Bool[np.ndarray, "rows columns"], some: Bool[np.ndarray, "rows columns"]
) -> Bool[np.ndarray, "rows columns"]:
    """The connected parts of a mask that hold cells of another."""
    parts = cv2.connectedComponents(mask.view(np.uint8), connectivity=8)[1]
    return np.isin(parts, np.unique(parts[mask & some]))


def _grown(
    mask: Bool[np.ndarray, "rows columns"], side: int = 3
) -> Bool[np.ndarray, "rows columns"]:
    """A mask with the cells around it, in squares of so many cells a side."""
    return cv2.dilate(mask.view(np.uint8), np.ones((side, side), np.uint8)) > 0


def _parts(mask: Bool[np.ndarray, "rows columns"]) -> list[Bool[np.ndarray, "rows columns"]]:
    """The connected parts of a mask, without specks."""
    if mask.sum() <= _SPECK_CELLS:
        return []
    count, parts, stats, _ = cv2.connectedComponentsWithStats(mask.view(np.uint8), connectivity=8)
    return [parts == k for k in range(1, count) if stats[k, cv2.CC_STAT_AREA] > _SPECK_CELLS]
