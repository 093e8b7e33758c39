"""A route: the path that a robot follows, and its progress along it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from jaxtyping import Float64

from hypernav.core.actions import Action
from hypernav.core.geometry.transforms import Pose2
from hypernav.planning.planner import PlannedPath

_NEAR_M = 0.25
"""Distance, metres, up to which two positions on a path count as the same."""


@dataclass(frozen=True)
class DeadEnd:
    """A position from which no sequence of actions leads on along a path.

    Attributes:
        position: The position ``(x, y)``, ``map`` frame, metres.
        clearance_m: Distance from obstacles that the path keeps, metres.
        end: End of the path, ``(x, y)``, metres.
    """

    position: tuple[float, float]
    clearance_m: float
    end: tuple[float, float]

    def is_on(self, path: PlannedPath, clearance_m: float) -> bool:
        """Whether a path of the same clearance leads through this position to the same end."""
        is_alike = clearance_m == self.clearance_m and math.dist(path.end, self.end) <= _NEAR_M
        return is_alike and _distance_m(self.position, path.waypoints) <= _NEAR_M


@dataclass(frozen=True, eq=False)
class Route:
    """A path and the robot's progress along it. A `Navigator` replaces it in every step.

    Attributes:
        path: The path that is followed; None without one.
        next_waypoint: Index of the first waypoint that the robot has not passed.
        actions: Actions that are left of the sequence under way.
        expected: Pose that the robot must have for the rest of the sequence to hold.
        arrived: Whether the latest step gave no action because the robot is at the path's end.
        age: Number of steps since the path was planned.
        clearance_m: Distance from obstacles that the path keeps, metres.
        tolerance_m: Distance within which a waypoint counts as passed, metres.
        destinations: Points ``(x, y)`` that the path was planned to, metres, as for `Navigator`.
        dead_ends: Positions from which paths led nowhere.
    """

    path: PlannedPath | None = None
    next_waypoint: int = 1
    actions: tuple[Action, ...] = ()
    expected: Pose2 | None = None
    arrived: bool = False
    age: int = 0
    clearance_m: float = math.inf
    tolerance_m: float = 0.0
    destinations: tuple[Float64[np.ndarray, "_ 2"], ...] = ()
    dead_ends: frozenset[DeadEnd] = frozenset()

    def along(self, path: PlannedPath | None, clearance_m: float, tolerance_m: float) -> "Route":
        """The route along a new path; the sequence of actions is kept if the end is the same."""
        goes_on = (
            path is not None
            and self.path is not None
            and math.dist(path.end, self.path.end) <= tolerance_m
        )
        return replace(
            self,
            path=path,
            next_waypoint=1,
            actions=self.actions if goes_on else (),
            arrived=False,
            clearance_m=clearance_m,
            tolerance_m=tolerance_m,
        )

    def seen_from(self, robot: Pose2) -> "Route":
        """The route updated for the robot's pose: waypoints near it or behind it count as passed.

        Steps are long, so the robot often passes a waypoint at a distance. A waypoint that was
        passed stays passed.
        """
        if self.path is None:
            return self
        passed = self.next_waypoint
        for corner, following in list(pairwise(self.path.waypoints))[passed:]:
            ahead, beside = along_line(corner, following, robot)
            near = robot.distance_to(*corner) <= self.tolerance_m
            if not near and not (ahead > 0.0 and abs(beside) <= self.tolerance_m):
                break
            passed += 1
        return self if passed == self.next_waypoint else replace(self, next_waypoint=passed)

    def points_left(self, robot: Pose2) -> tuple[tuple[float, float], ...]:
        """The robot's position and the waypoints that it has not passed, ``(x, y)``, metres."""
        if self.path is None:
            return ()
        return (robot.xy, *self.path.waypoints[self.seen_from(robot).next_waypoint :])

    def remaining(self, robot: Pose2) -> list[tuple[float, float]]:
        """The `points_left`, metres, waypoints rounded to millimetres; empty without a path."""
        points = self.points_left(robot)
        return [*points[:1], *((round(x, 3), round(y, 3)) for x, y in points[1:])]

    def left_m(self, robot: Pose2) -> float:
        """Length of the path that is left, metres; 0 without a path."""
        return sum(math.dist(*leg) for leg in pairwise(self.points_left(robot)))

    def leads_nowhere(self, path: PlannedPath, clearance_m: float) -> bool:
        """Whether a path leads through a position from which one to its end led nowhere before."""
        return any(one.is_on(path, clearance_m) for one in self.dead_ends)


def along_line(
    start: tuple[float, float], end: tuple[float, float], robot: Pose2
) -> tuple[float, float]:
    """Distance of the robot from a line's start along it, and to the left of it, metres."""
    length = math.dist(start, end) or 1.0
    dx, dy = (end[0] - start[0]) / length, (end[1] - start[1]) / length
    x, y = robot.x - start[0], robot.y - start[1]
    return (x * dx + y * dy, y * dx - x * dy)


def _distance_m(position: tuple[float, float], corners: Sequence[tuple[float, float]]) -> float:
    """Distance of a position from a polyline, metres."""
    ends = np.array(corners, dtype=np.float64)
    starts, legs = ends[:-1], np.diff(ends, axis=0)
    away = np.array(position) - starts
    along = (away * legs).sum(axis=1) / np.maximum((legs**2).sum(axis=1), 1e-12)
    nearest = starts + np.clip(along, 0.0, 1.0)[:, None] * legs
    return float(np.linalg.norm(nearest - np.array(position), axis=1).min())
