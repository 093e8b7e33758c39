"""Arrival and progress of a robot driven by Nav2, judged by odometry."""

import logging
import math

from hypernav.core.geometry.transforms import Pose2, wrap_angle
from hypernav.robot.ros2.config import Nav2Config
from hypernav.robot.ros2.nav2.aims import Aim

_LOG = logging.getLogger(__name__)

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

    def is_at(self, goal: Pose2, robot: Pose2, seconds: float, *, is_standing: bool) -> bool:
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
        """Create it; no warning has been given.

        Args:
            config: What counts as reached, and as blocked.
        """
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
