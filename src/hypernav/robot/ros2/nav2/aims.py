"""Goals on the path of an agent, for a navigation that finds its own route to each."""

from collections.abc import Sequence

from hypernav.core.geometry.transforms import Pose2, wrap_angle
from hypernav.robot.driving.driven_robot import TICK_S
from hypernav.robot.motion.path_ahead import PathAhead
from hypernav.robot.ros2.config import Nav2Config

_AIM_EVERY_S = 0.5
"""Shortest time between two goals on one path, for a robot that has not passed the first."""
_LOST_M = 1.0
"""Length that a robot may drive along its path between two looks: an answer is waited for."""


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

    def is_on(self, path: Sequence[tuple[float, float]]) -> bool:
        """Whether a path is this one, on which the robot has made progress already."""
        return tuple(path) == self._path

    def at(self, robot: Pose2) -> Pose2:
        """The goal for a robot at a pose; asked with every command."""
        config, self._looks = self._config, self._looks + 1
        along_m = self._ahead.pass_to(*robot.xy, within_m=max(config.ahead_m, _LOST_M))
        left_m = self._aim_m - along_m
        is_new = left_m > 0.0 and self._looks * TICK_S < _AIM_EVERY_S
        if self._aim is not None and (is_new or left_m > config.ahead_m / 2.0):
            return self._aim
        self._aim_m = self._ahead.aim_m(*robot.xy, along_m, config.ahead_m, config.corner_cut_m)
        x, y = self._ahead.point(self._aim_m)
        away_m = robot.distance_to(x, y)
        bearing = robot.bearing_to(x, y) if away_m > config.reached_m else 0.0
        self._aim, self._looks = Pose2(x, y, wrap_angle(robot.yaw + bearing)), 0
        return self._aim
