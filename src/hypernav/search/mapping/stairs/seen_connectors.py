"""Connectors between floors, seen without training.

Stairs are told from furniture by what they are for: a robot that takes their steps could walk on
them from the floor to far above or below it. Stairs down are mostly out of a level camera's sight.
They are told by an open edge of the floor, wide enough for the robot, beyond which the camera sees
below the floor.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import cv2
import numpy as np
from jaxtyping import Bool, Float64

from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.search.mapping.config import STAIRS_M
from hypernav.search.mapping.elevation_map import LEVEL_M, Ground, closed
from hypernav.search.mapping.stairs.connectors import Connector, Passage

LEAST_M2 = 0.1
"""Ground that far from the floor's height, within the robot's reach, square metres."""
_HIGH_M = 0.65
"""Height, metres, to which steps are seen at least that count without the first one."""
TREAD_M = 0.3
"""Length of a tread, metres, about."""
_DROP_M2 = 0.25
"""Presumed stairs down, within the robot's reach, square metres."""
_ALONG_M = 1.0
"""Length of the stairs from their end, metres, that tells their direction."""
_WHOLE_M = 1.0
"""Distance from which the edge of a floor is seen whole, metres."""
_SPECK_CELLS = 10
_GAP_CELLS = 5
"""Width of a gap between steps, cells, from which it parts them."""

EDGE_M = 1.5
"""Distance to both sides of the end of stairs, metres, in which their edge is looked for."""
_BEFORE_EDGE_M = 0.15
"""Distance before it at which there is floor; a tread beyond it there is none."""
_HEADROOM_M = np.arange(0.5, 1.5, 0.05)
"""Distances beyond the head of stairs down, metres, at which nothing is above them."""
_ACROSS_M = np.arange(-0.3, 0.3, 0.05)
"""Distances to the left of their axis, metres, that are looked at there."""
_MOST_CLOSED = 0.35
"""Share of these that may be floor or wall."""


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
        if min(ground.area_m2(part & high), ground.area_m2(part & ~high)) >= LEAST_M2:
            found += _connector(ground, part, floor, floor_z, goes_up=True)
    for part in _parts(below):
        presumed = part & ground.presumed
        if ground.area_m2(part & low) >= LEAST_M2 or ground.area_m2(presumed) >= _DROP_M2:
            found += _connector(ground, part, floor, floor_z, goes_up=False)
    return found


def reliable(
    seen: Sequence[Connector],
    known: Sequence[Connector],
    position: tuple[float, float],
    ground: Ground,
    floor_z: float,
) -> list[Connector]:
    """The sightings without those of edges of the floor that are too near to be seen whole.

    Of these a camera sees the ends only. They count if ground below the floor was seen near them,
    from farther away. If they lead where a known connector does, they count as that one, whose
    place they don't change.

    Args:
        seen: The sightings.
        known: The known connectors.
        position: The robot ``(x, y)``, metres.
        ground: Ground around the robot.
        floor_z: Height of the floor, metres.
    """
    counted = list[Connector]()
    for one in seen:
        is_whole = math.dist(one.end, position) >= _WHOLE_M
        if one.goes_up or is_whole or shows_steps(ground, one, floor_z):
            counted.append(one)
        else:
            there = (k for k in known if k.is_same(one) and k.leads_along(one))
            counted += [replace(one, end=k.end, axis=k.axis) for k in there][:1]
    return counted


def shows_steps(ground: Ground, down: Connector, floor_z: float) -> bool:
    """Whether ground below the floor was seen near the end of stairs down."""
    with np.errstate(invalid="ignore"):
        below = ground.reached & ground.seen & (ground.measured <= floor_z - LEVEL_M)
    return ground.area_m2(below & (ground.distances_m(down.end) <= _ALONG_M)) >= LEAST_M2


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
        if ground.area_m2(high) >= LEAST_M2:
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
    """Steps up, with up to two right before them that the camera does not see from so near."""
    side = 2 * math.ceil(2.0 * TREAD_M / ground.grid.resolution_m) + 1
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


def without_sides(
    known: Sequence[Connector], floor: int, ground: Ground, floor_z: float, grid: OccupancyGrid
) -> tuple[Connector, ...]:
    """The known connectors, of which none counts that is the side of a stairwell.

    It is an edge of the floor, too, but no steps were seen there, and soon beyond it there is floor
    again, or a wall: the floor above a flight is open until people can walk below it. Such a one is
    neither relied on nor looked at until new images show it as stairs.

    Args:
        known: The connectors.
        floor: Number of the robot's floor.
        ground: Ground around the robot.
        floor_z: Height of its floor, metres.
        grid: Map of that floor.
    """
    return tuple(
        replace(one, sightings=0)
        if one.floor == floor
        and one.passage is Passage.UNTRIED
        and not one.goes_up
        and sum(edge_beside(ground, one, floor_z)) > 0.0
        and not shows_steps(ground, one, floor_z)
        and not _has_headroom(one, ground, floor_z, grid)
        else one
        for one in known
    )


def edge_beside(ground: Ground, one: Connector, floor_z: float) -> tuple[float, float]:
    """How far the edge between floor and steps goes on to the left and right of its end, metres.

    At most `EDGE_M` to each side; 0 to both where there is none.
    """
    ahead = np.array([math.cos(one.axis), math.sin(one.axis)])
    left = np.array([-ahead[1], ahead[0]])
    beside_m = np.arange(0.0, EDGE_M, ground.grid.resolution_m)
    reach_m = [0.0, 0.0]
    for side, sign in enumerate((1.0, -1.0)):
        edge = np.array(one.end) + sign * beside_m[:, None] * left
        before, beyond = edge - _BEFORE_EDGE_M * ahead, edge + TREAD_M * ahead
        is_edge = ground.grid.picked(ground.reached, before)
        is_edge &= ground.grid.picked(ground.grid.free, beyond) & ~_is_floor(
            ground, beyond, floor_z
        )
        reach_m[side] = float(beside_m[-1] if is_edge.all() else beside_m[is_edge.argmin()])
    return reach_m[0], reach_m[1]


def _has_headroom(down: Connector, ground: Ground, floor_z: float, grid: OccupancyGrid) -> bool:
    """Whether neither floor nor wall lies across the way, right beyond the end of stairs down."""
    cos, sin = math.cos(down.axis), math.sin(down.axis)
    x = down.end[0] + _HEADROOM_M[:, None] * cos - _ACROSS_M * sin
    y = down.end[1] + _HEADROOM_M[:, None] * sin + _ACROSS_M * cos
    points = np.stack([x.ravel(), y.ravel()], axis=1)
    is_closed = grid.picked(grid.cells, points) == Cell.OCCUPIED
    is_closed |= _is_floor(ground, points, floor_z)
    return bool((is_closed.reshape(x.shape).mean(axis=1) <= _MOST_CLOSED).all())


def _is_floor(
    ground: Ground, points: Float64[np.ndarray, "n 2"], floor_z: float
) -> Bool[np.ndarray, " n"]:
    """Whether ground at a floor's height was seen at positions ``(x, y)``, metres."""
    with np.errstate(invalid="ignore"):
        is_level = np.abs(ground.grid.picked(ground.measured, points) - floor_z) <= LEVEL_M
    return ground.grid.picked(ground.seen, points) & is_level
