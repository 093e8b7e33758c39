"""The contract of a robot's base: what is needed to drive it by velocities."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float32

from hypernav.core.embodiment import Embodiment
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.robot.client.robot import Sensed
from hypernav.robot.motion.velocity import Velocity


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
