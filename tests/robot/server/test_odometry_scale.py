"""Depth images tell whether odometry is in metres."""

import math

import numpy as np
import pytest

from hypernav.core.embodiment import Embodiment
from hypernav.core.errors import SensorError
from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.observation import Observation
from hypernav.robot.server.odometry_scale import OdometryScale
from hypernav.robot.wire.requests import ObservationFacts
from hypernav.robot.wire.values import PlanarPose

CAMERA = PinholeCamera.from_hfov(640, 480, 79.0)
HEIGHT_M = 0.88


def drive(recorded, scale: float, *, noise: float = 0.0) -> None:
    """Show a drive whose odometry is wrong by a factor, and whose depth errs by a share."""
    rng, watched = np.random.default_rng(0), OdometryScale()
    for number, ((x, y, yaw), depth) in enumerate(zip(*recorded, strict=True)):
        there = Pose2(scale * x, scale * y, yaw)
        seen = Observation(
            rgb=np.zeros((*depth.shape, 3), np.uint8),
            depth=depth * rng.normal(1.0, noise, depth.shape).astype(np.float32),
            camera=CAMERA,
            camera_to_map=there.to_transform() @ optical_to_base(HEIGHT_M),
            robot=there,
        )
        facts = ObservationFacts(
            sequence=number,
            stamp_s=float(number),
            base_to_odom=PlanarPose(x=there.x, y=there.y, yaw=math.remainder(yaw, math.tau)),
        )
        watched.check()
        watched.note(facts, seen)


@pytest.fixture(scope="module")
def recorded(test_data):
    """The poses and depth images of a drive through a real house."""
    episode = np.load(test_data / "episodes" / "small_house.npz")
    return episode["xy_yaw"].tolist(), episode["depth_mm"].astype(np.float32) / np.float32(1000.0)


@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_odometry_in_metres_is_taken(recorded, noise):
    drive(recorded, 1.0, noise=noise)


@pytest.mark.parametrize("scale", [0.97, 1.03])
def test_wheels_that_err_a_little_are_taken(recorded, scale):
    drive(recorded, scale)


@pytest.mark.parametrize("scale", [1.0 / 3.0, 0.3048, 0.5, 2.0, 3.0, 3.28])
def test_odometry_in_other_units_is_named(recorded, scale):
    with pytest.raises(SensorError, match=r"odometry .* moved .* depth images show about .*metres"):
        drive(recorded, scale)


def test_along_walls_and_in_the_void_nothing_is_shown():
    """A corridor without an end looks the same after every step."""
    rows = np.arange(CAMERA.height) + 0.5 - CAMERA.cy
    columns = np.arange(CAMERA.width) + 0.5 - CAMERA.cx
    to_floor = HEIGHT_M * CAMERA.fy / np.maximum(rows, 1e-3)[:, None]
    to_wall = CAMERA.fx / np.maximum(np.abs(columns), 1e-3)[None, :]
    depth = np.minimum(to_floor, to_wall).astype(np.float32)
    depth[depth > Embodiment().camera.max_depth_m] = 0.0
    poses = [(0.25 * step, 0.0, 0.0) for step in range(9)]
    for shown in (depth, np.zeros_like(depth)):
        drive((poses, [shown] * len(poses)), 3.0)
