"""The contract of a robot: what a search asks of it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float32, UInt8

from hypernav.core.embodiment import Action, Embodiment
from hypernav.core.errors import SensorError
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.observation import LabelledPixels, Observation
from hypernav.robot.wire.values import LATEST_S

_ORIGIN = Pose2(0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Sensed:
    """All that a robot senses at one moment.

    Attributes:
        rgb: Colour image.
        depth: Depth image of the same camera, metres along the optical axis; 0, NaN or infinite
            where there is no return.
        odometry: Pose of the base in the frame of its odometry, which drifts but never jumps.
        stamp_s: Time at which the images were taken, on the robot's clock, seconds. Images that
            are not newer than the last ones end the search.
        odom_to_map: Pose of the odometry frame in the ``map`` frame, by localisation; may jump.
            Without localisation the two frames are the same.
        camera_to_base: Pose of the camera on the robot; None takes the embodiment's.
        height_m: Height of the base above the floor of the start, metres.
        truth: True labels, in simulation only.
    """

    rgb: UInt8[np.ndarray, "height width 3"]
    depth: Float32[np.ndarray, "height width"]
    odometry: Pose2
    stamp_s: float
    odom_to_map: Pose2 = _ORIGIN
    camera_to_base: Transform | None = None
    height_m: float = 0.0
    truth: LabelledPixels | None = None

    def __post_init__(self) -> None:
        """Refuse images that can't be sent.

        Raises:
            SensorError: Shape, type or time is wrong.
        """
        if self.rgb.dtype != np.uint8 or self.rgb.ndim != 3 or self.rgb.shape[2] != 3:
            raise SensorError(
                "Sensed.rgb: expected height × width × 3 of type uint8, got "
                f"{' × '.join(map(str, self.rgb.shape))} of type {self.rgb.dtype}"
            )
        if self.depth.ndim != 2 or not np.issubdtype(self.depth.dtype, np.floating):
            raise SensorError(
                "Sensed.depth: expected height × width of type float32, metres, got "
                f"{' × '.join(map(str, self.depth.shape))} of type {self.depth.dtype}"
            )
        if not 0.0 <= self.stamp_s <= LATEST_S:
            raise SensorError(
                f"Sensed.stamp_s: expected seconds from 0 to {LATEST_S:g}, got {self.stamp_s:g}"
            )
        for name, pose in (("odometry", self.odometry), ("odom_to_map", self.odom_to_map)):
            if not isinstance(pose, Pose2) or not np.isfinite([pose.x, pose.y, pose.yaw]).all():
                raise SensorError(
                    f"Sensed.{name}: expected a Pose2 of finite numbers, got {pose!r:.80}"
                )
        if self.camera_to_base is not None and not np.isfinite(self.camera_to_base.matrix).all():
            raise SensorError("Sensed.camera_to_base: expected finite numbers")

    def observation(self, camera: PinholeCamera, camera_to_base: Transform) -> Observation:
        """The same data as an agent's observation.

        Args:
            camera: Camera of the images.
            camera_to_base: Pose of the camera on the robot, for a robot that does not sense it.
        """
        base_to_odom = self.odometry.to_transform(self.height_m)
        base_to_map = self.odom_to_map.to_transform() @ base_to_odom
        x, y, _ = base_to_map.translation.tolist()
        return Observation(
            rgb=self.rgb,
            depth=np.where(is_measured(self.depth), self.depth, np.float32(0.0)),
            camera=camera,
            camera_to_map=base_to_map @ (self.camera_to_base or camera_to_base),
            robot=Pose2(x, y, base_to_map.yaw),
            truth=self.truth,
        )


class Executed(StrEnum):
    """How an action ended."""

    DONE = "done"
    """The motion was made, as far as the robot knows."""
    BLOCKED = "blocked"
    """Something is in the way and has not moved."""
    STOPPED = "stopped"
    """`Robot.stop` ended the motion before its end."""


@runtime_checkable
class Robot(Protocol):
    """A robot with an RGB-D camera and odometry. Actions are those of its embodiment."""

    @property
    def embodiment(self) -> Embodiment:
        """Body, camera, and effect of the actions."""
        ...

    def observe(self) -> Sensed:
        """Images and pose, taken now."""
        ...

    def execute(self, action: Action) -> Executed:
        """Make a step or a turn, and return when it is done. Never called with STOP.

        The robot stops for anything in its way, waits a while, and goes on if it is gone; else the
        answer is `Executed.BLOCKED`.
        """
        ...

    def stop(self) -> None:
        """Stand still at once; a motion under way ends and is not taken up again.

        May be called from any thread, any number of times, also while `execute` runs.
        """
        ...


@runtime_checkable
class FollowsPaths(Protocol):
    """A robot that can also drive smoothly along a path (``--motion continuous``)."""

    def follow(
        self, path: Sequence[tuple[float, float]], until: Callable[[Pose2], bool]
    ) -> Executed:
        """Drive along a path, and return without braking as soon as `until` says so.

        It stops at the end of the path. The next call of this or `Robot.execute` follows at once.

        Args:
            path: Corners ``(x, y)`` from the robot on, metres, in the frame of the odometry.
            until: Function of the present odometry that says whether to return; called about ten
                times a second.
        """
        ...
