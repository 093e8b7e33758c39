"""What odometry shows of a goal that another navigates to: arrival, and progress."""

import math

from hypernav.core.geometry.transforms import Pose2, wrap_angle

_MOVED_M, _TURNED_RAD = 0.1, math.radians(5.0)
"""Motion that is progress."""
_SETTLED_S = 2.0
"""Time at the goal after which a body that sways has arrived, too."""


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
    """For how long a robot has not moved.

    Attributes:
        has_moved: Whether it has moved at all.
    """

    def __init__(self, robot: Pose2) -> None:
        """Begin where the robot is."""
        self._from = robot
        self._still_s = 0.0
        self.has_moved: bool = False

    def still_s(self, robot: Pose2, seconds: float) -> float:
        """Time for which the robot has been where it is, seconds.

        Args:
            robot: Its pose now.
            seconds: Time since the last look, without that in which it was not to move.
        """
        turned = abs(wrap_angle(robot.yaw - self._from.yaw))
        if robot.distance_to(*self._from.xy) > _MOVED_M or turned > _TURNED_RAD:
            self._from, self._still_s, self.has_moved = robot, 0.0, True
        else:
            self._still_s += seconds
        return self._still_s
