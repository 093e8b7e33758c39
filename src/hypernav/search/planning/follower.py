"""Path following: a route, the progress along it, and the next discrete action."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from jaxtyping import Float32, Float64

from hypernav.core.embodiment import Action, MotionConfig
from hypernav.core.geometry.grid import has_cell
from hypernav.core.geometry.transforms import Pose2, wrap_angle
from hypernav.search.planning.config import PlanningConfig
from hypernav.search.planning.costmap import (
    HORIZON_M,
    LEAST_GAIN_M,
    LOOK_AHEAD_M,
    SIDEWAYS_M,
    SURROUNDINGS_M,
    Costmap,
)
from hypernav.search.planning.costmap_kernels import plan_actions
from hypernav.search.planning.planner import PlannedPath, costs_to_go, is_blocked

_NEAR_M = 0.25
"""Distance, metres, up to which two positions on a path count as the same."""
_AS_EXPECTED = 0.02
"""Deviation from the expected pose, metres and radians, up to which all goes as planned."""
_ANGLE_SLACK = 1e-9
"""Slack, radians, so that rounding makes no turn of a bearing of exactly the tolerance."""
_ACTIONS = (Action.MOVE_FORWARD, Action.TURN_LEFT, Action.TURN_RIGHT)


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


@dataclass(frozen=True, eq=False)
class PathFollower:
    """Follows routes. It has no state of its own.

    Attributes:
        config: Steering and tolerances.
        motion: Length of a step and angle of a turn.
    """

    config: PlanningConfig
    motion: MotionConfig

    def next_action(
        self, route: Route, robot: Pose2, costmap: Costmap | None = None
    ) -> tuple[Action | None, Route]:
        """The next action along the path of a route.

        Args:
            route: The route of the step before.
            robot: Pose of the robot.
            costmap: Costmap around the robot, for ``steering: lattice``. Without it the robot
                steers by "waypoint", whatever the configuration says.

        Returns:
            A turn or a step, and the route from here on. No action if there is no path, if the
            robot is at its end (`Route.arrived`), or if no step brings it nearer.
        """
        route = route.seen_from(robot)
        path = route.path
        if path is None:
            return None, replace(route, arrived=False)
        if self.config.steering == "lattice" and costmap is not None:
            action, route = self._by_lattice(route, path, robot, costmap)
            if action is None and costmap.is_tight and not self._is_at_end(path, robot):
                action = self._to_waypoint(route, path, robot)
        else:
            action = self._to_waypoint(route, path, robot)
        arrived = action is None and self._is_at_end(path, robot)
        return action, route if arrived == route.arrived else replace(route, arrived=arrived)

    def _is_at_end(self, path: PlannedPath, robot: Pose2) -> bool:
        # Steps have a fixed length, so the last one may end before the path's end or beyond it.
        return robot.distance_to(*path.end) <= max(self._tolerance, self.motion.forward_m)

    @property
    def _tolerance(self) -> float:
        return self.config.waypoint_tolerance_m

    def _to_waypoint(self, route: Route, path: PlannedPath, robot: Pose2) -> Action | None:
        """By "waypoint" (paper): turn if the next one is too far off the heading, else go."""
        if route.next_waypoint < len(path.waypoints) - 1:
            return self._turn_or_go(robot.bearing_to(*path.waypoints[route.next_waypoint]))
        return self._to_end(path, robot)

    def _to_end(self, path: PlannedPath, robot: Pose2) -> Action | None:
        """By "waypoint" to the path's end; no action where no step is worth taking."""
        off = robot.distance_to(*path.end)
        before = path.waypoints[-2] if len(path.waypoints) > 1 else robot.xy
        overshot = off <= self.motion.forward_m and along_line(before, path.end, robot)[0] > (
            math.dist(before, path.end)
        )
        # A long step passes a near end, and the next path would lead back from there.
        gain_m = off - abs(off - self.motion.forward_m)
        if off <= self._tolerance or overshot or gain_m < LEAST_GAIN_M:
            return None
        return self._turn_or_go(robot.bearing_to(*path.end))

    def _turn_or_go(self, bearing: float) -> Action:
        # A bearing below half a turn's angle grows by turning: the robot would turn to and fro.
        tolerance_deg = max(self.config.heading_tolerance_deg, self.motion.turn_angle_deg / 2.0)
        if abs(bearing) <= math.radians(tolerance_deg) + _ANGLE_SLACK:
            return Action.MOVE_FORWARD
        return Action.TURN_LEFT if bearing > 0.0 else Action.TURN_RIGHT

    def _by_lattice(
        self, route: Route, path: PlannedPath, robot: Pose2, costmap: Costmap
    ) -> tuple[Action | None, Route]:
        """The next action of the best sequence, searched some steps ahead, and the route.

        A sequence is carried out to its end, where less is left to go than before. A new search
        after every action could lead in circles.
        """
        if robot.distance_to(*path.end) <= self._tolerance:
            return None, route  # walls are thicker than the tolerance, so none lies between
        if not (route.actions and self._goes_as_planned(route, robot, costmap)):
            actions = self._search_actions(route, path, robot, costmap)
            if actions is None:
                return self._to_waypoint(route, path, robot), route
            route = replace(route, actions=actions)
        if not route.actions:
            return None, route
        action, *rest = route.actions
        return action, replace(route, actions=tuple(rest), expected=self._after(robot, action))

    def _goes_as_planned(self, route: Route, robot: Pose2, costmap: Costmap) -> bool:
        """Whether the robot has the expected pose, and the next step forward is still open."""
        expected = route.expected
        if expected is None or expected.distance_to(*robot.xy) > _AS_EXPECTED:
            return False
        if abs(wrap_angle(expected.yaw - robot.yaw)) > _AS_EXPECTED:
            return False
        pose = robot
        for action in route.actions:
            before, pose = pose, self._after(pose, action)
            if action is Action.MOVE_FORWARD:
                return not is_blocked((before.xy, pose.xy), costmap)
        return True

    def _after(self, robot: Pose2, action: Action) -> Pose2:
        """Pose after an action, if nothing blocks it."""
        if action is Action.MOVE_FORWARD:
            return robot.ahead(self.motion.forward_m)
        turn = math.radians(self.motion.turn_angle_deg)
        return Pose2(robot.x, robot.y, robot.yaw + (turn if action is Action.TURN_LEFT else -turn))

    def _search_actions(
        self, route: Route, path: PlannedPath, robot: Pose2, costmap: Costmap
    ) -> tuple[Action, ...] | None:
        """The best sequence; empty if none leads on, None if the search is not possible here."""
        size = costmap.grid.resolution_m
        costs, (bottom, left) = _surroundings(costmap, robot)
        row, column = costmap.continuous(*robot.xy)
        aim_row, aim_column = costmap.grid.cell_of(*self._ahead(route, path, robot))
        here = (math.floor(row) - bottom, math.floor(column) - left)
        aim = (aim_row - bottom, aim_column - left)
        if not all(_is_open(costs, cell) for cell in (here, aim)):
            return None
        to_go = costs_to_go(costs, aim, here, SIDEWAYS_M / size)
        if np.isinf(to_go[here]):
            return None
        turns = self.motion.turns_of_a_circle
        headings = robot.yaw + np.arange(turns) * math.radians(self.motion.turn_angle_deg)
        actions, rest = plan_actions(
            costs,
            to_go,
            row - bottom,
            column - left,
            np.sin(headings),
            np.cos(headings),
            self.motion.forward_m / size,
            self.config.turn_cost_m * (self.motion.turn_angle_deg / 30.0) / size,
            self._tolerance / size,
            HORIZON_M / size,
        )
        if rest > to_go[here] - LEAST_GAIN_M / size:
            return ()
        return tuple(_ACTIONS[action] for action in actions)

    def _ahead(self, route: Route, path: PlannedPath, robot: Pose2) -> tuple[float, float]:
        """The point on the path that is `LOOK_AHEAD_M` farther along it than the robot."""
        left = LOOK_AHEAD_M
        for start, end in list(pairwise(path.waypoints))[route.next_waypoint - 1 :]:
            length = math.dist(start, end)
            along = (
                min(max(along_line(start, end, robot)[0], 0.0), length)
                if left == LOOK_AHEAD_M
                else 0.0
            )
            if along + left < length:
                share = (along + left) / length
                return (
                    start[0] + share * (end[0] - start[0]),
                    start[1] + share * (end[1] - start[1]),
                )
            left -= length - along
        return path.end


def _surroundings(
    costmap: Costmap, robot: Pose2
) -> tuple[Float32[np.ndarray, "rows columns"], tuple[int, int]]:
    """Costs of the cells around the robot, and their lowest ``(row, column)`` on the costmap."""
    row, column = costmap.grid.cell_of(*robot.xy)
    reach = math.ceil(SURROUNDINGS_M / costmap.grid.resolution_m)
    bottom, left = max(row - reach, 0), max(column - reach, 0)
    costs = costmap.costs[bottom : row + reach + 1, left : column + reach + 1]
    return np.ascontiguousarray(costs), (bottom, left)


def _is_open(costs: Float32[np.ndarray, "rows columns"], cell: tuple[int, int]) -> bool:
    return has_cell(costs.shape, *cell) and bool(costs[cell] > 0.0)
