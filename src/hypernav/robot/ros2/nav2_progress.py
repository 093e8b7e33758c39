"""Goals for Nav2, which finds its own route to each, and how much of a motion is done.

Arrival and progress are judged by odometry.
"""

import logging
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from hypernav.core.geometry.transforms import Pose2, wrap_angle
from hypernav.robot.driving.driven_robot import TICK_S
from hypernav.robot.driving.pure_pursuit import PathAhead
from hypernav.robot.ros2.config import Nav2Config

_LOG = logging.getLogger(__name__)

_AIM_EVERY_S = 0.5
"""Shortest time between two goals on one path, for a robot that has not passed the first."""
_PASSED_M = 0.01
"""Length before a goal at which it is passed, metres: progress is known to some 0.0125 m only."""
_LOST_M = 1.0
"""Length that a robot may drive along its path between two updates."""
_STRAY_M = 0.5
"""Longest detour of Nav2 in one motion; whether to take a longer one is for the agent to decide."""


@dataclass(frozen=True)
class Aim:
    """A goal of a motion, and how far the robot is with the motion.

    Attributes:
        goal: The goal for Nav2, metres and radians, in the frame of the odometry.
        made: The robot's position for progress: on a path, the point of the path nearest to it.
        left_m: Length left to drive, metres; None for a turn.
        left_rad: Difference of its heading from the goal's, radians.
        is_astray: Whether the robot is too far from the line of the motion.
    """

    goal: Pose2
    made: Pose2
    left_m: float | None
    left_rad: float
    is_astray: bool


class Motion(Protocol):
    """A motion that Nav2 makes with one or several goals."""

    @property
    def end(self) -> Pose2:
        """Pose at its end."""
        ...

    def at(self, robot: Pose2) -> Aim:
        """The goal for a robot at a pose; asked with every command."""
        ...


class ToPose:
    """A step or a turn: one goal, to which a straight line leads."""

    def __init__(self, start: Pose2, end: Pose2) -> None:
        """Begin a motion."""
        self._start, self._end = start, end
        self._is_turn = start.xy == end.xy
        self._line = PathAhead([start.xy] if self._is_turn else [start.xy, end.xy], sharp_deg=180.0)

    @property
    def end(self) -> Pose2:
        """Pose at its end."""
        return self._end

    def at(self, robot: Pose2) -> Aim:
        """The goal, which stays the same."""
        along_m = self._line.pass_to(*robot.xy, within_m=self._line.length_m)
        return Aim(
            self._end,
            robot,
            None if self._is_turn else robot.distance_to(*self._end.xy),
            abs(wrap_angle(self._end.yaw - robot.yaw)),
            robot.distance_to(*self._line.point(along_m)) > _STRAY_M,
        )


class Aims:
    """Goals along a path: each as far ahead as the robot can go straight, as few as will do."""

    def __init__(self, path: Sequence[tuple[float, float]], config: Nav2Config) -> None:
        """Take a path.

        Args:
            path: Corners ``(x, y)``, metres, in the frame of the odometry.
            config: How far ahead goals are.
        """
        self._path, self._config = tuple(path), config
        self._ahead = PathAhead(path, sharp_deg=180.0)
        self._aim: Pose2 | None = None
        self._aim_m = 0.0
        self._looks = 0

    @property
    def end(self) -> Pose2:
        """The path's end, without a heading."""
        return Pose2(*self._path[-1], 0.0)

    def is_on(self, path: Sequence[tuple[float, float]]) -> bool:
        """Whether a path is this one, on which the robot has made progress already."""
        return tuple(path) == self._path

    def at(self, robot: Pose2) -> Aim:
        """The goal for a robot at a pose; asked with every command.

        The robot may be beside the path, up to the distance by which corners may be cut.
        """
        config = self._config
        along_m = self._ahead.pass_to(*robot.xy, within_m=max(config.ahead_m, _LOST_M))
        beside = Pose2(*self._ahead.point(along_m), robot.yaw)
        aside_m = robot.distance_to(*beside.xy)
        goal = self._goal(robot, along_m)
        return Aim(
            goal,
            robot if aside_m <= config.corner_cut_m else beside,
            self._ahead.length_m - along_m,
            abs(wrap_angle(goal.yaw - robot.yaw)),
            aside_m > config.corner_cut_m + _STRAY_M,
        )

    def _goal(self, robot: Pose2, along_m: float) -> Pose2:
        config, self._looks = self._config, self._looks + 1
        left_m = self._aim_m - along_m
        is_new = left_m > _PASSED_M and self._looks * TICK_S < _AIM_EVERY_S
        if self._aim is not None and (is_new or left_m > config.ahead_m / 2.0):
            return self._aim
        self._aim_m = self._ahead.aim_m(*robot.xy, along_m, config.ahead_m, config.corner_cut_m)
        x, y = self._ahead.point(self._aim_m)
        away_m = robot.distance_to(x, y)
        bearing = robot.bearing_to(x, y) if away_m > config.reached_m else 0.0
        self._aim, self._looks = Pose2(x, y, wrap_angle(robot.yaw + bearing)), 0
        return self._aim


_GAINED_M, _GAINED_RAD = 0.1, math.radians(5.0)
"""Smallest gain towards the goal that counts as progress."""
_SETTLED_S = 2.0
"""Time at the goal after which a swaying body counts as arrived."""
_SHORT_S = 3.0
"""Time without progress after which Nav2 may take its goal for reached."""
_SHORT_M, _SHORT_RAD = 0.4, math.radians(45.0)
"""Distances from a goal within which a goal checker may take it for reached."""


class Arrival:
    """Whether a robot has arrived at a pose: it is near, and stands or stays there."""

    def __init__(self, reached_m: float, reached_rad: float) -> None:
        """Begin away from any goal.

        Args:
            reached_m: Largest distance from the goal, metres.
            reached_rad: Largest difference of the heading, radians.
        """
        self._reached_m, self._reached_rad = reached_m, reached_rad
        self._there_s = 0.0

    def has_settled_at(
        self, goal: Pose2, robot: Pose2, seconds: float, *, is_standing: bool
    ) -> bool:
        """Look at the robot.

        Args:
            goal: Pose to be reached.
            robot: Pose of the robot in the same frame.
            seconds: Time since the last look.
            is_standing: Whether the robot stands.
        """
        is_there = (
            robot.distance_to(*goal.xy) <= self._reached_m
            and abs(wrap_angle(goal.yaw - robot.yaw)) <= self._reached_rad
        )
        self._there_s = self._there_s + seconds if is_there else 0.0
        return is_there and (is_standing or self._there_s > _SETTLED_S)


class Progress:
    """Measures how long a robot has made no progress towards its goal.

    Progress is only what brings it nearer than ever before: for a drive a shorter remaining length,
    for a turn a smaller difference of the heading. A recovery of Nav2 that spins, or backs up and
    returns, is no progress.

    Attributes:
        is_made: Whether there was any progress.
        taken_s: Time since the beginning, seconds: the sum over all calls.
    """

    def __init__(self) -> None:
        """Begin a motion."""
        self._least: float | None = None
        self._idle_s = 0.0
        self.is_made: bool = False
        self.taken_s: float = 0.0

    def idle_s(self, aim: Aim, seconds: float) -> float:
        """Time without progress, seconds.

        Args:
            aim: How far the robot is now.
            seconds: Time since the last call, without pauses in which it was not to move.
        """
        self.taken_s += seconds
        left = aim.left_rad / _GAINED_RAD if aim.left_m is None else aim.left_m / _GAINED_M
        if self._least is None:
            self._least = left
        if left < self._least - 1.0:
            self._least, self._idle_s, self.is_made = left, 0.0, True
        else:
            self._idle_s += seconds
        return self._idle_s


class ShortOfGoals:
    """Warns, once, that Nav2 stops short of goals because its goal checker is more tolerant.

    Without the warning the only sign would be that each motion counts as blocked, much later.
    """

    def __init__(self, config: Nav2Config) -> None:
        """Create it; no warning has been given."""
        self._config, self._is_said = config, False

    def look(self, goal: Pose2, robot: Pose2, idle_s: float) -> None:
        """Look at a robot that has not reached its goal.

        Args:
            goal: The goal.
            robot: Pose of the robot in the same frame.
            idle_s: Time for which it has come no nearer, seconds.
        """
        left_m, left_rad = robot.distance_to(*goal.xy), abs(wrap_angle(goal.yaw - robot.yaw))
        if self._is_said or idle_s < _SHORT_S or left_m > _SHORT_M or left_rad > _SHORT_RAD:
            return
        self._is_said, config = True, self._config
        _LOG.warning(
            "the robot has come no nearer for %.0f s, %.2f m and %.0f° (%.2f rad) from its goal, "
            "which is reached within %g m and %g° (nav2.reached_m, nav2.reached_deg). If Nav2 "
            "stops there, set xy_goal_tolerance and yaw_goal_tolerance of its goal checker "
            "(parameters of controller_server, by default 0.25 m and 0.25 rad) below them; else "
            "something is in its way. The motion counts as blocked after %g s (nav2.blocked_s)",
            *(idle_s, left_m, math.degrees(left_rad), left_rad),
            *(config.reached_m, config.reached_deg, config.blocked_s),
        )
