"""An empty room with a door, computed in closed form: observations without a simulator."""

import math
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float64

from hypernav.core.embodiment import Action, CameraConfig, Embodiment
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.transforms import Pose2, wrap_angle
from hypernav.core.naming.labels import ObjectLabel
from hypernav.core.observation import LabelledPixels, Observation

_LOW = np.array([-2.0, -2.0, 0.0])
_HIGH = np.array([4.0, 2.0, 2.5])
_DOOR_HALF_M = 0.5
_MARGIN_M = 0.3
_COLORS = np.array([[190, 180, 170], [170, 185, 190], [180, 170, 190]], np.uint8)

_ROBOT = Embodiment(camera=CameraConfig(width=160, height=120))

DOOR = "door"
"""The one object of the room: a door in the middle of the wall ahead."""


@dataclass
class BoxRoom:
    """A robot in the room; it starts at the origin of the ``map`` frame and faces the door.

    Attributes:
        pose: Pose of the robot, ``map`` frame.
        labels: Whether observations carry ground-truth labels.
        embodiment: Embodiment of the robot.
    """

    pose: Pose2 = field(default_factory=lambda: Pose2(0.0, 0.0, 0.0))
    labels: bool = True
    embodiment: Embodiment = _ROBOT

    def observe(self) -> Observation:
        """The observation at the present pose."""
        lens = self.embodiment.camera
        camera = lens.intrinsics
        camera_to_map = self.pose.to_transform() @ lens.camera_to_base
        rays = camera.rays() @ camera_to_map.rotation.T
        depth, side, points = _cast(camera_to_map.translation, rays)
        shade = (points * 4.0).astype(np.int64).sum(axis=-1) % 2 * 20
        rgb = _COLORS[side] - shade[..., None].astype(np.uint8)
        is_door = (points[..., 0] > _HIGH[0] - 1e-6) & (np.abs(points[..., 1]) < _DOOR_HALF_M)
        ids = np.where(is_door, np.int32(0), np.int32(-1))
        return Observation(
            rgb=rgb,
            depth=np.where(
                is_measured(depth, lens.min_depth_m, lens.max_depth_m), depth, 0.0
            ).astype(np.float32),
            camera=camera,
            camera_to_map=camera_to_map,
            robot=self.pose,
            truth=LabelledPixels(ids, {0: ObjectLabel(DOOR)}) if self.labels else None,
        )

    def step(self, action: Action) -> None:
        """Take an action; walls stop the robot."""
        x, y, yaw = self.pose.x, self.pose.y, self.pose.yaw
        if action is Action.MOVE_FORWARD:
            low, high = _LOW[:2] + _MARGIN_M, _HIGH[:2] - _MARGIN_M
            ahead = np.array(
                [
                    x + self.embodiment.motion.forward_m * math.cos(yaw),
                    y + self.embodiment.motion.forward_m * math.sin(yaw),
                ]
            )
            x, y = (float(value) for value in np.clip(ahead, low, high))
        elif action is not Action.STOP:
            yaw = wrap_angle(
                yaw
                + (
                    math.radians(self.embodiment.motion.turn_angle_deg)
                    if action is Action.TURN_LEFT
                    else -math.radians(self.embodiment.motion.turn_angle_deg)
                )
            )
        self.pose = Pose2(x, y, yaw)


def _cast(
    origin: Float64[np.ndarray, "3"], rays: Float64[np.ndarray, "height width 3"]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Depth along the optical axis, axis of the wall that a ray hits, and the point hit."""
    with np.errstate(divide="ignore"):
        inverse = 1.0 / rays
    distances = np.where(rays > 0.0, (_HIGH - origin) * inverse, (_LOW - origin) * inverse)
    distances = np.where(rays == 0.0, np.inf, distances)
    side = distances.argmin(axis=-1)
    depth = distances.min(axis=-1)
    return depth, side, origin + depth[..., None] * rays
