"""Flights of stairs, from one level to the next, and where the robot goes on them.

A level camera sees no steps that lead down, nor the railing beside them. What it sees is where a
flight begins, in the middle between railings or walls, and in which direction: so the robot keeps
to the axis from there.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

import cv2
import numpy as np
from jaxtyping import Bool, Float64

from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2, wrap_angle
from hypernav.search.mapping.elevation_map import LEVEL_M, POSE_ERROR_M, Ground
from hypernav.search.mapping.stairs.connectors import Connector
from hypernav.search.mapping.stairs.seen_connectors import (
    EDGE_M,
    LEAST_M2,
    TREAD_M,
    connectors_in,
    edge_beside,
)

_WALLS_M = 2.0
"""Distance from the end of stairs, metres, within which walls and railings tell their direction."""
_BESIDE_M = (0.2, 1.3)
"""Distances from the middle line of stairs, metres, between which what stands beside them lies."""
_LEAST_SIDE_M = 0.4
"""Length of a straight line of it, metres, from which it counts."""
_STANDS_OUT = 1.3
"""Length of the lines on both sides, by that in any other direction, from which they count."""
_SAME_DEG = 10
"""Difference, degrees, up to which a direction is no other one."""

_Place = tuple[float, float, float]
"""Position ``(x, y, z)``, ``map`` frame, metres."""

_AHEAD_M = 0.9
"""Distance of the next aim on stairs, metres."""
_NEXT_M = 2.5
"""Length of the axis, metres, on which presumed stairs must begin for the robot to follow it."""
_SAME_TREAD_M = 0.06
_BESIDE_AXIS_M = 0.15
"""Distance from the axis within which the robot's aim on stairs that it does not see lies."""
HALF_WIDTH_M = 0.42
"""Half the width of narrow stairs, metres: nothing farther from the axis of a flight down counts as
ground, and where there is room the robot keeps so far from edges."""
_FRONT_M = 0.2
"""Distance before a flight, metres, from which a robot that comes from the front is on its axis."""
_FRONT_HALF_M = 0.3
"""Distance from the axis, metres, beyond which it does not come onto the flight then."""
_ASKEW = 0.4
"""Deviation of a flight from parallels and right angles, in right angles."""
_OTHER_WAY = math.radians(60.0)
"""Angle between a step down and a flight beyond which the step was not taken on that flight."""
_OFF_AXIS = math.radians(30.0)
"""Angle from the axis of a flight up to which the ground may seem to fall: heights err."""
_STEEP = 0.3
"""Slope of a step down from which it was on stairs, also where it led askew over them."""
_APART_M = 0.1
"""Spread of a robot's way to both sides of a line, metres, from which it tells how ground falls."""
_MOST = 0.75
"""Share of the ground where a flight begins, from which it is known to be level or not."""
BEGINS_M = 1.5
"""Distance within which stairs begin from where they seem to, metres."""
_AROUND_M = 1.0
"""Distance within which a landing tells its height, metres."""
_UNDERFOOT_M = 0.25
"""Distance within which the robot stands on the ground."""


def along_walls(one: Connector, grid: OccupancyGrid) -> Connector:
    """A connector with the direction of the walls and railings on both sides of it.

    Many images show these, while the first edge of stairs is often seen from one side, askew. A
    wall on one side alone may be one that the stairs are not parallel to. Where nothing straight
    stands on both sides, or it does in more than one direction, the connector stays as it is.

    Args:
        one: The connector. Its direction may be wrong by right angles; it keeps these.
        grid: Map of its floor.
    """
    left, right = _beside(one.end, grid)
    both = np.where(np.minimum(left, right) >= _LEAST_SIDE_M, np.sqrt(left * right), 0.0)
    both = both.reshape(2, 90).max(axis=0)
    best = int(both.argmax())
    is_other = np.abs((np.arange(90) - best + 45) % 90 - 45) > _SAME_DEG
    if both[best] <= _STANDS_OUT * both[is_other].max():
        return one
    angle = math.radians(best)
    quarters = round((one.axis - angle) / (math.pi / 2.0))
    return replace(one, axis=wrap_angle(angle + quarters * math.pi / 2.0))


def _beside(end: tuple[float, float], grid: OccupancyGrid) -> Float64[np.ndarray, "sides=2 180"]:
    """Longest straight lines of walls to the left and right of stairs that lead in each direction.

    The directions are 0 to 179 degrees; the lengths are in metres.
    """
    reach = math.ceil(_WALLS_M / grid.resolution_m) + 2
    row, column = grid.cell_of(*end)
    corner = np.maximum((row - reach, column - reach), 0)
    part = grid.cells[corner[0] : max(row + reach, 0), corner[1] : max(column + reach, 0)]
    walls = part == Cell.OCCUPIED
    if not walls.any():  # the stairs may lie off the map
        return _lines(b"", grid.resolution_m)
    is_inside = cv2.erode(walls.view(np.uint8), np.ones((3, 3), np.uint8)) > 0  # as in steps up
    away = grid.centres_of(np.argwhere(walls & ~is_inside) + corner) - end
    away = away[np.linalg.norm(away, axis=1) <= _WALLS_M]
    return _lines(away.tobytes(), grid.resolution_m)


@lru_cache(maxsize=8)
def _lines(walls: bytes, side_m: float) -> Float64[np.ndarray, "sides=2 180"]:
    """The lines beside stairs, kept: these are asked for in every step of a climb.

    Args:
        walls: Positions ``(x, y)`` of their cells from the end of the stairs, float64, metres.
        side_m: Side of a cell, metres.
    """
    away = np.frombuffer(walls).reshape(-1, 2)
    angles = np.radians(np.arange(180.0))
    to_left_m = away @ np.stack([-np.sin(angles), np.cos(angles)])
    nearest, farthest = (round(one / side_m) for one in _BESIDE_M)
    line = np.floor(to_left_m / side_m).astype(np.int64) + farthest
    is_beside = (line >= 0) & (line < 2 * farthest)
    line += 2 * farthest * np.arange(180)
    cells = np.bincount(line[is_beside], minlength=180 * 2 * farthest).reshape(180, 2 * farthest)
    right, left = cells[:, : farthest - nearest], cells[:, farthest + nearest :]
    lines = np.stack([left.max(axis=1), right.max(axis=1)]) * side_m
    lines.flags.writeable = False  # the kept ones
    return lines


def flight_from(connector: Connector, *, goes_up: bool) -> Connector:
    """The flight of a connector, in the direction in which the robot goes over it."""
    if connector.goes_up is goes_up:
        return connector
    return replace(connector, goes_up=goes_up, axis=connector.axis + math.pi)


def first_flight(ground: Ground, first: Connector, floor_z: float) -> Connector:
    """The first flight, in the one of three directions in which most of it was seen or presumed.

    Of an edge that is seen from one side, the direction is told worst.

    Args:
        ground: Ground around the robot, which is on the floor before the stairs.
        first: The flight; its direction or one at right angles to it is right.
        floor_z: Height of the floor, metres.
    """
    with np.errstate(invalid="ignore"):
        rise = (ground.measured - floor_z) * (1.0 if first.goes_up else -1.0)
        steps = ground.reached & (ground.presumed | (ground.seen & (rise > LEVEL_M)))

    def seen(axis: float) -> int:
        ahead_m, beside_m = ground.along(first.end, axis)
        return int((steps & (ahead_m > 0.0) & (ahead_m < _NEXT_M) & (beside_m < 0.3)).sum())

    axes = [wrap_angle(first.axis + turn * math.pi / 2.0) for turn in (0.0, 1.0, -1.0)]
    return _in_the_middle(ground, replace(first, axis=max(axes, key=seen)), floor_z)


def _in_the_middle(ground: Ground, first: Connector, floor_z: float) -> Connector:
    """The first flight, with its end in the middle of the edge between floor and steps.

    Where that edge goes on to one side, as on a platform, it stays where it is.
    """
    left_m, right_m = edge_beside(ground, first, floor_z)
    if max(left_m, right_m) >= EDGE_M - ground.grid.resolution_m:
        return first
    off_m = (left_m - right_m) / 2.0
    x, y = first.end
    end = (x - off_m * math.sin(first.axis), y + off_m * math.cos(first.axis))
    return replace(first, end=end)


def landing_z(ground: Ground, robot: Pose2, robot_z: float) -> float:
    """Height of the level ground around the robot, metres, as the camera sees it.

    A simulated robot stands on a mesh whose heights are wrong by up to a step there.
    """
    with np.errstate(invalid="ignore"):
        is_near = np.abs(ground.heights - robot_z) <= POSE_ERROR_M
    is_near &= ground.seen & ~ground.stood & ground.reached
    is_near &= ground.distances_m(robot.xy) <= _AROUND_M
    return float(np.median(ground.heights[is_near])) if is_near.any() else robot_z


def underfoot_z(ground: Ground, robot: Pose2, robot_z: float) -> float:
    """Height of the ground under the robot, metres, as the camera sees it.

    A simulated robot on stairs stands on a mesh whose heights are wrong by up to two steps there.
    """
    seen = ground.seen & ~ground.stood & (ground.distances_m(robot.xy) <= _UNDERFOOT_M)
    return float(np.median(ground.measured[seen])) if seen.any() else robot_z


def flight_down(
    ground: Ground, robot: Pose2, robot_z: float, before: Connector | None, first: Connector
) -> Connector | None:
    """The next flight down, as seen from a landing; None if none is seen.

    Flights are parallel or at right angles to each other; what is seen askew is not relied on.

    Args:
        ground: Ground around the robot; unseen steps down presumed.
        robot: Pose of the robot.
        robot_z: Height of the landing, metres.
        before: The flight as known so far: if it begins near the robot, another one is none.
        first: The first flight of the stairs.
    """
    found = list[Connector]()
    for one in connectors_in(ground, first.floor, robot_z):
        quarters = wrap_angle(one.axis - first.axis) / (math.pi / 2.0)
        if one.goes_up or abs(quarters - round(quarters)) > _ASKEW:
            continue
        flight = replace(one, axis=first.axis + round(quarters) * math.pi / 2.0)
        if _passed_m(flight, robot) <= TREAD_M:
            found.append(flight)
    if before is not None:
        is_behind = _passed_m(before, robot) > TREAD_M
        before = None if is_behind or _is_level(ground, before, robot_z) else before
    if before is not None and robot.distance_to(*before.end) <= BEGINS_M:
        found = [one for one in found if one.is_same(before) and _agree(one, before)] or [before]
    return min(found, key=lambda one: robot.distance_to(*one.end), default=None)


def flight_underfoot(
    flight: Connector | None, first: Connector, way: Sequence[_Place], robot: Pose2
) -> Connector:
    """The flight down that the robot is on, as its latest steps tell, which led down on it.

    The axis goes past where the robot stands, and leads where the ground fell under its steps; a
    single step tells only about where.

    Args:
        flight: The flight as known so far.
        first: The first flight of the stairs.
        way: Where the robot came by ``(x, y, z)``, its position now included, at least two, metres.
        robot: Pose of the robot.
    """
    (x, y, _), falls = way[-2], _falls_towards(way, None if flight is None else flight.axis)
    went = math.atan2(robot.y - y, robot.x - x)
    if falls is not None and (flight is None or abs(wrap_angle(falls - flight.axis)) > _OFF_AXIS):
        return replace(first, end=robot.xy, axis=falls)
    if flight is None or abs(wrap_angle(went - flight.axis)) > _OTHER_WAY:
        quarters = round((went - first.axis) / (math.pi / 2.0))
        return replace(first, end=robot.xy, axis=wrap_angle(first.axis + quarters * math.pi / 2.0))
    left = (-math.sin(flight.axis), math.cos(flight.axis))
    beside_m = (robot.x - flight.end[0]) * left[0] + (robot.y - flight.end[1]) * left[1]
    off_m = beside_m - max(min(beside_m, _BESIDE_AXIS_M), -_BESIDE_AXIS_M)
    end = (flight.end[0] + off_m * left[0], flight.end[1] + off_m * left[1])
    return replace(flight, end=end)


def _falls_towards(way: Sequence[_Place], axis: float | None) -> float | None:
    """Direction in which the ground falls under a way's last steps that all led down, radians.

    None where these lie on one line, along which alone they tell how the ground falls, and where
    an axis tells their heights as well, as far as these can be relied on. Landings end a flight:
    meshes slope there, but less than stairs do.
    """
    count = 1
    while count < len(way) and _slope(way[-count - 1], way[-count]) >= _STEEP:
        count += 1
    points = np.array(way[-count:], dtype=np.float64)
    points -= points.mean(axis=0)
    if count < 3 or np.linalg.svd(points[:, :2], compute_uv=False)[-1] < _APART_M:
        return None
    if axis is not None:
        ahead = points[:, :2] @ np.array([[math.cos(axis)], [math.sin(axis)]])
        (rise,) = np.linalg.lstsq(ahead, points[:, 2], rcond=None)[0]
        off_m = points[:, 2] - rise * ahead[:, 0]
        if rise <= -_STEEP and np.abs(off_m).max() <= LEVEL_M:
            return None
    slope = np.linalg.lstsq(points[:, :2], points[:, 2], rcond=None)[0]
    return math.atan2(-slope[1], -slope[0])


def _slope(before: _Place, after: _Place) -> float:
    """How far a step led down, by its length."""
    return (before[2] - after[2]) / max(math.dist(before[:2], after[:2]), LEVEL_M)


def _passed_m(flight: Connector, robot: Pose2) -> float:
    """How far past the beginning of a flight the robot is, along it, metres."""
    away = (robot.x - flight.end[0], robot.y - flight.end[1])
    return away[0] * math.cos(flight.axis) + away[1] * math.sin(flight.axis)


def _is_level(ground: Ground, flight: Connector, landing_z: float) -> bool:
    """Whether the landing was seen to go on where a flight seemed to begin."""
    ahead_m, beside_m = ground.along(flight.end, flight.axis)
    begins = (beside_m <= _BESIDE_AXIS_M) & (ahead_m >= TREAD_M) & (ahead_m <= _AHEAD_M)
    with np.errstate(invalid="ignore"):
        is_level = ground.seen & (np.abs(ground.measured - landing_z) <= LEVEL_M)
    return bool(is_level[begins].sum() > _MOST * begins.sum())


def _agree(one: Connector, other: Connector) -> bool:
    """Whether two of these flights lead in the same direction."""
    return abs(wrap_angle(one.axis - other.axis)) < math.pi / 4.0


def on_flight(
    ground: Ground, robot: Pose2, robot_z: float, flight: Connector | None, *, goes_up: bool
) -> Ground:
    """The ground that is on the way: nothing beside the axis of a flight down, and no path back."""
    sign = 1.0 if goes_up else -1.0
    back_z = sign * min(sign * robot_z, sign * underfoot_z(ground, robot, robot_z))
    with np.errstate(invalid="ignore"):
        closed = ground.seen & (sign * (back_z - ground.heights) > POSE_ERROR_M)
    if flight is not None and not goes_up:
        ahead_m, beside_m = ground.along(flight.end, flight.axis)
        closed |= (ahead_m > 0.0) & (beside_m > HALF_WIDTH_M) & ~ground.seen
    return ground.without(closed, robot.xy)


def from_front(ground: Ground, robot: Pose2, flight: Connector) -> Ground:
    """The ground without the sides of a flight's first steps, where it has no railing."""
    ahead_m, beside_m = ground.along(flight.end, flight.axis)
    return ground.without((ahead_m > -_FRONT_M) & (beside_m > _FRONT_HALF_M), robot.xy)


def stairs_ahead(
    ground: Ground,
    robot: Pose2,
    robot_z: float,
    flight: Connector | None,
    *,
    goes_up: bool,
    on_slope: bool,
) -> Bool[np.ndarray, "rows columns"]:
    """Mask of the ground to go to next on stairs; empty where they end.

    On a flight down it lies ahead on the axis, as long as the robot is on a slope, or stairs are
    seen or presumed there. Else it is the highest ground in reach, or the lowest that was seen;
    beyond a landing, it is any presumed stairs.
    """
    least_cells = max(round(LEAST_M2 / ground.grid.resolution_m**2), 1)
    sign = 1.0 if goes_up else -1.0
    with np.errstate(invalid="ignore"):
        rise = sign * (ground.heights - robot_z)
        beyond = ground.reached & (rise > LEVEL_M + 0.04) & ~ground.presumed
    presumed = ground.reached & ground.presumed
    if not goes_up:
        beyond &= ground.seen
        if flight is not None:
            ahead_m = ground.along(robot.xy, flight.axis)[0]
            on_axis = ground.along(flight.end, flight.axis)[1] <= _BESIDE_AXIS_M
            on_axis &= ground.reached if on_slope else beyond | presumed
            on_axis &= (ahead_m > TREAD_M) & (ahead_m < (_AHEAD_M if on_slope else _NEXT_M))
            if on_axis.sum() >= least_cells:
                return on_axis & (ahead_m >= min(_AHEAD_M, float(ahead_m[on_axis].max())) - 0.1)
    if beyond.sum() < least_cells:
        beyond = presumed
    else:
        most = np.partition(rise[beyond], -least_cells)[-least_cells]
        beyond &= rise >= most - _SAME_TREAD_M
        if not on_slope:
            beyond |= presumed
    if not beyond.any():
        return beyond
    away = ground.distances_m(robot.xy)
    return beyond & (away >= min(_AHEAD_M, float(away[beyond].max())))


def first_ahead(
    ground: Ground, robot: Pose2, mask: Bool[np.ndarray, "rows columns"]
) -> Bool[np.ndarray, "rows columns"]:
    """The part of a mask ahead of the robot, if there is any; nothing where the robot is on it."""
    if mask[ground.grid.cell_of(*robot.xy)]:
        return np.zeros_like(mask)
    ahead = ahead_of(ground, robot, mask)
    return ahead if ahead.any() else mask


def ahead_of(
    ground: Ground, robot: Pose2, mask: Bool[np.ndarray, "rows columns"]
) -> Bool[np.ndarray, "rows columns"]:
    """The part of a mask ahead of the robot."""
    ahead_m, beside_m = ground.along(robot.xy, robot.yaw)
    return mask & (ahead_m > beside_m)
