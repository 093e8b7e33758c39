"""Path following: the next discrete action along a path."""

import math
from itertools import pairwise

import numpy as np
from jaxtyping import Float32

from hypernav.core.actions import Action
from hypernav.core.embodiment import MotionConfig
from hypernav.core.geometry.bounds import has_cell
from hypernav.core.geometry.transforms import Pose2, wrap_angle
from hypernav.planning.astar import costs_to_go
from hypernav.planning.config import PlanningConfig
from hypernav.planning.costmap import Costmap
from hypernav.planning.motion_kernels import plan_actions
from hypernav.planning.planner import PlannedPath, is_blocked

_LEAST_GAIN_M = 0.05
"""Smallest gain for which a sequence of actions is worth taking."""
_HORIZON_M = 3.0
"""Length of path over which actions are searched: beyond the next door, and bend."""
_LOOK_AHEAD_M = 4.0
"""Length of path to the point that the actions aim at; beyond the horizon."""
_SURROUNDINGS_M = 5.0
"""Half the side of the part of the map that actions are searched in."""
_SIDEWAYS_M = 1.0
"""Length by which the path to the aim may grow in between."""
_SAME_POSITION_M = 0.02
_SAME_HEADING_RAD = 0.02
_ANGLE_SLACK = 1e-9
"""A bearing of exactly the tolerance must not turn into a turn by rounding."""
_ACTIONS = (Action.MOVE_FORWARD, Action.TURN_LEFT, Action.TURN_RIGHT)


class PathFollower:
    """Follows one path at a time and tracks the robot's progress along it."""

    def __init__(self, config: PlanningConfig, motion: MotionConfig) -> None:
        """Begin without a path.

        Args:
            config: Steering and tolerances.
            motion: Length of a step and angle of a turn.
        """
        self._config = config
        self._motion = motion
        self._path: PlannedPath | None = None
        self.follow(None)

    def follow(self, path: PlannedPath | None) -> None:
        """Take a new path, or drop the present one."""
        end = None if self._path is None else self._path.end
        self._path = path
        self._next = 1
        self._arrived = False
        if path is None or end is None or math.dist(path.end, end) > self._tolerance:
            self._plan: list[Action] = []

    @property
    def planned(self) -> int:
        """Number of actions that are left of the sequence under way; 0 without one."""
        return len(self._plan)

    @property
    def path(self) -> PlannedPath | None:
        """The path that is being followed."""
        return self._path

    @property
    def arrived(self) -> bool:
        """Whether the latest `next_action` found the robot at the end of the path."""
        return self._arrived

    def remaining(self, robot: Pose2) -> tuple[tuple[float, float], ...]:
        """The path that is left: the robot and the waypoints that it has not passed, metres."""
        if self._path is None:
            return ()
        self._pass_waypoints(self._path, robot)
        return (robot.xy, *self._path.waypoints[self._next :])

    def next_action(self, robot: Pose2, costmap: Costmap | None = None) -> Action | None:
        """The next action along the path.

        Args:
            robot: Pose of the robot.
            costmap: Costmap around the robot, for ``steering: lattice``. Without it the robot
                steers to the next waypoint whatever the configuration says.

        Returns:
            A turn or a step. None if there is no path, if the robot is at its end (`arrived`), or
            if no step brings it nearer.
        """
        self._arrived = False
        if self._path is None:
            return None
        self._pass_waypoints(self._path, robot)
        if self._config.steering == "lattice" and costmap is not None:
            action = self._by_lattice(self._path, robot, costmap)
            if action is None and costmap.is_tight and not self._is_at_end(self._path, robot):
                action = self._to_waypoint(self._path, robot)
        else:
            action = self._to_waypoint(self._path, robot)
        self._arrived = action is None and self._is_at_end(self._path, robot)
        return action

    def _is_at_end(self, path: PlannedPath, robot: Pose2) -> bool:
        # A step may end up to half its length away from where it should.
        return robot.distance_to(*path.end) <= max(self._tolerance, self._motion.forward_m)

    @property
    def _tolerance(self) -> float:
        return self._config.waypoint_tolerance_m

    def _pass_waypoints(self, path: PlannedPath, robot: Pose2) -> None:
        """Go on to the next waypoint when one is near, or when the robot is beyond it.

        Steps are long, so a waypoint is often stepped over. It never comes back.
        """
        legs = list(pairwise(path.waypoints))[self._next :]
        for corner, following in legs:
            ahead, beside = _along(corner, following, robot)
            near = robot.distance_to(*corner) <= self._tolerance
            if not near and not (ahead > 0.0 and abs(beside) <= self._tolerance):
                break
            self._next += 1

    def _to_waypoint(self, path: PlannedPath, robot: Pose2) -> Action | None:
        """The paper's follower: turn if the next waypoint is too far off the heading, else go."""
        aim = path.waypoints[min(self._next, len(path.waypoints) - 1)]
        if self._next >= len(path.waypoints) - 1:
            off = robot.distance_to(*path.end)
            before = path.waypoints[-2] if len(path.waypoints) > 1 else robot.xy
            overshot = off <= self._motion.forward_m and _along(before, path.end, robot)[0] > (
                math.dist(before, path.end)
            )
            if off <= self._tolerance or overshot:
                return None
        return self._turn_or_go(robot.bearing_to(*aim))

    def _turn_or_go(self, bearing: float) -> Action:
        # Less than half a turn off cannot be made good: the robot would turn to and fro.
        tolerance_deg = max(self._config.heading_tolerance_deg, self._motion.turn_angle_deg / 2.0)
        if abs(bearing) <= math.radians(tolerance_deg) + _ANGLE_SLACK:
            return Action.MOVE_FORWARD
        return Action.TURN_LEFT if bearing > 0.0 else Action.TURN_RIGHT

    def _by_lattice(self, path: PlannedPath, robot: Pose2, costmap: Costmap) -> Action | None:
        """The next action of the best sequence, searched some steps ahead.

        A sequence is carried out to its end, where less is left to go than before. A new choice
        after every action could go in circles.
        """
        if robot.distance_to(*path.end) <= self._tolerance:
            return None  # no wall is thin enough to lie between
        if not (self._plan and self._goes_as_planned(robot, costmap)):
            actions = self._search_actions(path, robot, costmap)
            if actions is None:
                return self._to_waypoint(path, robot)
            self._plan = actions
        if not self._plan:
            return None
        action = self._plan.pop(0)
        self._expected = self._after(robot, action)
        return action

    def _goes_as_planned(self, robot: Pose2, costmap: Costmap) -> bool:
        """Whether the robot is where its plan has it, and the plan's next step is still open."""
        expected = self._expected
        if expected.distance_to(*robot.xy) > _SAME_POSITION_M:
            return False
        if abs(wrap_angle(expected.yaw - robot.yaw)) > _SAME_HEADING_RAD:
            return False
        pose = robot
        for action in self._plan:
            before, pose = pose, self._after(pose, action)
            if action is Action.MOVE_FORWARD:
                return not is_blocked((before.xy, pose.xy), costmap)
        return True

    def _after(self, robot: Pose2, action: Action) -> Pose2:
        """Pose after an action, if nothing blocks it."""
        if action is Action.MOVE_FORWARD:
            step = self._motion.forward_m
            return Pose2(
                robot.x + step * math.cos(robot.yaw),
                robot.y + step * math.sin(robot.yaw),
                robot.yaw,
            )
        turn = math.radians(self._motion.turn_angle_deg)
        return Pose2(robot.x, robot.y, robot.yaw + (turn if action is Action.TURN_LEFT else -turn))

    def _search_actions(
        self, path: PlannedPath, robot: Pose2, costmap: Costmap
    ) -> list[Action] | None:
        """The best sequence; empty if none leads on, None if the search is not possible here."""
        size = costmap.grid.resolution_m
        costs, (bottom, left) = _surroundings(costmap, robot)
        row, column = costmap.continuous(*robot.xy)
        aim_row, aim_column = costmap.grid.cell_of(*self._ahead(path, robot))
        here = (math.floor(row) - bottom, math.floor(column) - left)
        aim = (aim_row - bottom, aim_column - left)
        if not all(_is_open(costs, cell) for cell in (here, aim)):
            return None
        to_go = costs_to_go(costs, aim, here, _SIDEWAYS_M / size)
        if np.isinf(to_go[here]):
            return None
        turns = self._motion.turns_of_a_circle
        headings = robot.yaw + np.arange(turns) * math.radians(self._motion.turn_angle_deg)
        actions, rest = plan_actions(
            costs,
            to_go,
            row - bottom,
            column - left,
            np.sin(headings),
            np.cos(headings),
            self._motion.forward_m / size,
            self._config.turn_cost_m * (self._motion.turn_angle_deg / 30.0) / size,
            self._tolerance / size,
            _HORIZON_M / size,
        )
        if rest > to_go[here] - _LEAST_GAIN_M / size:
            return []
        return [_ACTIONS[action] for action in actions]

    def _ahead(self, path: PlannedPath, robot: Pose2) -> tuple[float, float]:
        """The point on the path that is `_LOOK_AHEAD_M` farther along it than the robot."""
        left = _LOOK_AHEAD_M
        for start, end in list(pairwise(path.waypoints))[self._next - 1 :]:
            length = math.dist(start, end)
            along = (
                min(max(_along(start, end, robot)[0], 0.0), length)
                if left == _LOOK_AHEAD_M
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


def _along(
    start: tuple[float, float], end: tuple[float, float], robot: Pose2
) -> tuple[float, float]:
    """Distance of the robot along a line, and to the left of it, metres."""
    length = math.dist(start, end) or 1.0
    dx, dy = (end[0] - start[0]) / length, (end[1] - start[1]) / length
    x, y = robot.x - start[0], robot.y - start[1]
    return (x * dx + y * dy, y * dx - x * dy)


def _surroundings(
    costmap: Costmap, robot: Pose2
) -> tuple[Float32[np.ndarray, "rows columns"], tuple[int, int]]:
    """Costs of the cells around the robot, and row and column of their corner."""
    row, column = costmap.grid.cell_of(*robot.xy)
    reach = math.ceil(_SURROUNDINGS_M / costmap.grid.resolution_m)
    bottom, left = max(row - reach, 0), max(column - reach, 0)
    costs = costmap.costs[bottom : row + reach + 1, left : column + reach + 1]
    return np.ascontiguousarray(costs), (bottom, left)


def _is_open(costs: Float32[np.ndarray, "rows columns"], cell: tuple[int, int]) -> bool:
    return has_cell(costs.shape, *cell) and bool(costs[cell] > 0.0)
