"""Velocity of a robot that drives forward and turns, and the pose that it leads to."""

import math
from dataclasses import dataclass

from hypernav.core.geometry.transforms import Pose2, wrap_angle


@dataclass(frozen=True)
class Velocity:
    """Velocity of a robot's base, with the signs of REP 103, as in ``geometry_msgs/Twist``.

    Attributes:
        linear_m_s: Speed forward (``linear.x``), metres per second.
        angular_rad_s: Rate of rotation (``angular.z``), radians per second, positive to the left.
    """

    linear_m_s: float = 0.0
    angular_rad_s: float = 0.0

    @property
    def is_zero(self) -> bool:
        """Whether the robot stands still."""
        return self.linear_m_s == 0.0 and self.angular_rad_s == 0.0

    def moved(self, pose: Pose2, seconds: float) -> Pose2:
        """The pose after driving with this velocity, exactly: an arc, a line or a rotation."""
        turn = self.angular_rad_s * seconds
        # The chord of an arc is as long as the arc times sin(turn / 2) / (turn / 2).
        half = turn / 2.0
        shrunk = math.sin(half) / half if half else 1.0
        chord = self.linear_m_s * seconds * shrunk
        return Pose2(
            pose.x + chord * math.cos(pose.yaw + half),
            pose.y + chord * math.sin(pose.yaw + half),
            wrap_angle(pose.yaw + turn),
        )


STANDSTILL = Velocity()
"""No motion at all."""
