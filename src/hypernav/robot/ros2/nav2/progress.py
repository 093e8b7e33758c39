"""What odometry shows of a goal that another navigates to: arrival, progress, and what it lacks."""

import logging
import math

from hypernav.core.geometry.transforms import Pose2, wrap_angle
from hypernav.robot.ros2.config import Nav2Config

_LOG = logging.getLogger(__name__)

_MOVED_M, _TURNED_RAD = 0.1, math.radians(5.0)
"""Motion that is progress."""
_SETTLED_S = 2.0
"""Time at the goal after which a body that sways has arrived, too."""
_SHORT_S = 3.0
"""Time without motion after which Nav2 may be content with where the robot is."""
_SHORT_M, _SHORT_RAD = 0.4, math.radians(45.0)
"""Distances from a goal with which a goal checker may be content."""


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
    """For how long a robot has moved, and for how long it has not.

    Attributes:
        has_moved: Whether it has moved at all.
        taken_s: Time since the begin, seconds, as the looks say.
    """

    def __init__(self, robot: Pose2) -> None:
        """Begin where the robot is."""
        self._from = robot
        self._still_s = 0.0
        self.has_moved: bool = False
        self.taken_s: float = 0.0

    def still_s(self, robot: Pose2, seconds: float) -> float:
        """Time for which the robot has been where it is, seconds.

        Args:
            robot: Its pose now.
            seconds: Time since the last look, without that in which it was not to move.
        """
        self.taken_s += seconds
        turned = abs(wrap_angle(robot.yaw - self._from.yaw))
        if robot.distance_to(*self._from.xy) > _MOVED_M or turned > _TURNED_RAD:
            self._from, self._still_s, self.has_moved = robot, 0.0, True
        else:
            self._still_s += seconds
        return self._still_s


class ShortOfGoals:
    """Warns, once, that Nav2 stops short of goals: its goal checker is content sooner than we are.

    Nothing else tells it until each motion counts as blocked, much later.
    """

    def __init__(self, config: Nav2Config) -> None:
        """Begin without a warning.

        Args:
            config: What counts as reached, and as blocked.
        """
        self._config, self._is_said = config, False

    def look(self, goal: Pose2, robot: Pose2, still_s: float) -> None:
        """Look at a robot that has not reached its goal.

        Args:
            goal: The goal.
            robot: Pose of the robot in the same frame.
            still_s: Time for which it has not moved, seconds.
        """
        left_m, left_rad = robot.distance_to(*goal.xy), abs(wrap_angle(goal.yaw - robot.yaw))
        if self._is_said or still_s < _SHORT_S or left_m > _SHORT_M or left_rad > _SHORT_RAD:
            return
        self._is_said, config = True, self._config
        _LOG.warning(
            "the robot has not moved for %.0f s, %.2f m and %.0f° (%.2f rad) from its goal, which "
            "is reached within %g m and %g° (nav2.reached_m, nav2.reached_deg). If Nav2 is content "
            "there, set xy_goal_tolerance and yaw_goal_tolerance of its goal checker (parameters "
            "of controller_server, by default 0.25 m and 0.25 rad) below them; else something is "
            "in its way. The motion counts as blocked after %g s (nav2.blocked_s)",
            *(still_s, left_m, math.degrees(left_rad), left_rad),
            *(config.reached_m, config.reached_deg, config.blocked_s),
        )
