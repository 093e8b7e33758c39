"""Images of an empty floor, and views with arrows in them."""

import math

import numpy as np

from hypernav.core.embodiment import CameraConfig
from hypernav.core.exploring.guidance import Arrow, ArrowView
from hypernav.core.geometry.camera import optical_to_base
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.observation import Observation

CAMERA = CameraConfig(width=320, height=240)
HERE = Pose2(0.0, 0.0, 0.0)


def room_with_wall(
    wall_m: float = 3.0, *, robot: Pose2 = HERE, pitch_deg: float = 0.0, camera=CAMERA
) -> Observation:
    """Floor up to a wall straight ahead, across the robot's heading; the camera sees both."""
    lens = camera.intrinsics
    to_base = optical_to_base(camera.height_m, pitch_deg)
    rays = lens.rays() @ to_base.rotation.T
    with np.errstate(divide="ignore", invalid="ignore"):
        to_floor = np.where(rays[..., 2] < 0.0, -camera.height_m / rays[..., 2], np.inf)
        to_wall = np.where(rays[..., 0] > 0.0, wall_m / rays[..., 0], np.inf)
    depth = np.minimum(to_floor, to_wall)
    depth = np.where((depth > camera.min_depth_m) & (depth < camera.max_depth_m), depth, 0.0)
    return Observation(
        rgb=np.full((camera.height, camera.width, 3), 120, np.uint8),
        depth=depth.astype(np.float32),
        camera=lens,
        camera_to_map=robot.to_transform() @ to_base,
        robot=robot,
    )


def arrow(number: int, *, free_m: float = 2.0, explored: bool = False) -> Arrow:
    heading = math.radians(10.0 * number)
    return Arrow(number, heading, 1.0, (1.0, float(number)), (10.0, 10.0), free_m, explored)


def view_of(
    *arrows: Arrow, may_turn: bool = True, wanted: int = 1, asked: int = 0, facts=()
) -> ArrowView:
    def nothing():
        return np.zeros((4, 4, 3), np.uint8)

    return ArrowView(nothing, arrows, may_turn, wanted, asked, tuple(facts))
