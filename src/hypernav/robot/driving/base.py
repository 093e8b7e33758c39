"""A robot's base: velocities, the poses that they lead to, and what is needed to drive by them."""

import math
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float32

from hypernav.core.embodiment import Embodiment
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform, wrap_angle
from hypernav.robot.client.robot import Sensed


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


@dataclass(frozen=True, eq=False)
class DepthView:
    """A depth image for obstacle checks alone; it may be coarse, but must come often.

    Attributes:
        depth: Depth, metres along the optical axis; 0, NaN or infinite where there is no return.
        camera: Intrinsics of the image.
        camera_to_base: Pose of the camera on the robot.
        stamp_s: Time at which the image was taken, on any clock, seconds; if the camera is frozen
            it stays the same.
        robot: Pose of the robot in the frame of the odometry at that time, not now: images arrive
            late, and the robot keeps driving.
    """

    depth: Float32[np.ndarray, "height width"]
    camera: PinholeCamera
    camera_to_base: Transform
    stamp_s: float
    robot: Pose2


@runtime_checkable
class Base(Protocol):
    """A robot's base: wheels, odometry and camera."""

    @property
    def embodiment(self) -> Embodiment:
        """Body, camera, and effect of the actions."""
        ...

    def sense(self) -> Sensed:
        """Images and pose for the search, taken now."""
        ...

    def odometry(self) -> Pose2:
        """Pose in the frame of the odometry."""
        ...

    def depth_view(self) -> DepthView:
        """The latest depth image."""
        ...

    def drive(self, velocity: Velocity, seconds: float) -> None:
        """Drive with a velocity for a number of seconds, then return."""
        ...

    def halt(self) -> None:
        """Command the base to stand still at once; may be called from any thread."""
        ...
