import math

import numpy as np
import pytest
from gymnasium import spaces
from hypothesis import given
from hypothesis import strategies as st

from box_scenes import room_boxes, scene_of
from hypernav.core.embodiment import CameraConfig
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.naming.labels import ObjectLabel
from hypernav.core.observation import LabelledPixels, Observation
from hypernav.lab.datasets.habitat_format import pose_to_habitat
from hypernav.lab.evaluation.habitat_lab.sensors import observed, semantic_ids_of, sensor_spaces
from hypernav.lab.evaluation.habitat_lab.task import HabitatTask
from hypernav.search.rivals.policy import pose_input

CAMERA = CameraConfig(width=8, height=8)
NO_IDS = np.zeros(1, np.int32)
ALL = HabitatTask(sensors=("rgb", "depth", "semantic"))

numbers = st.floats(-20.0, 20.0)
poses = st.builds(Pose2, numbers, numbers, st.floats(-math.pi, math.pi, exclude_max=True))


def seen_from(robot: Pose2, depth: float = 1.0, ids: np.ndarray | None = None) -> Observation:
    size = (CAMERA.height, CAMERA.width)
    return Observation(
        rgb=np.full((*size, 3), 7, np.uint8),
        depth=np.full(size, depth, np.float32),
        camera=CAMERA.intrinsics,
        camera_to_map=Transform(np.eye(3), np.zeros(3)),
        robot=robot,
        truth=None if ids is None else LabelledPixels(ids, {0: ObjectLabel("bed")}),
    )


def turned(quaternion: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """A vector turned by a quaternion ``[x, y, z, w]``."""
    axis, w = quaternion[:3], quaternion[3]
    return vector + 2.0 * np.cross(axis, np.cross(axis, vector) + w * vector)


def product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    axis = a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3])
    return np.array([*axis, a[3] * b[3] - a[:3] @ b[:3]])


@given(poses, poses)
def test_gps_and_compass_are_habitats_formulas(start, moved):
    """The formulas of ``EpisodicGPSSensor`` and ``EpisodicCompassSensor`` in Habitat's frame."""
    c, s = math.cos(start.yaw), math.sin(start.yaw)
    away = (c * moved.x - s * moved.y, s * moved.x + c * moved.y)
    robot = Pose2(start.x + away[0], start.y + away[1], start.yaw + moved.yaw)
    origin, start_rotation = map(np.array, pose_to_habitat(start, 0.3))
    position, rotation = map(np.array, pose_to_habitat(robot, 0.3))
    inverse = np.array([-1.0, -1.0, -1.0, 1.0])
    offset = turned(start_rotation * inverse, position - origin)
    heading = turned(product(rotation * inverse, start_rotation), np.array([0.0, 0.0, -1.0]))
    observation = observed(seen_from(moved), CAMERA, HabitatTask(), 0, NO_IDS)
    assert observation["gps"] == pytest.approx([-offset[2], offset[0]], abs=1e-4)
    compass = math.atan2(heading[0], -heading[2])
    assert math.remainder(float(observation["compass"][0]) - compass, math.tau) == pytest.approx(
        0.0, abs=1e-5
    )


@given(poses)
def test_gps_and_compass_are_what_trained_policies_are_fed(robot):
    observation = observed(seen_from(robot), CAMERA, HabitatTask(), 0, NO_IDS)
    ahead, right, heading = pose_input(robot, Pose2(0.0, 0.0, 0.0))
    assert observation["gps"] == pytest.approx([ahead, right], abs=1e-5)
    assert float(observation["compass"][0]) == pytest.approx(heading, abs=1e-5)


@pytest.mark.parametrize(
    ("metres", "shown"), [(0.0, 0.0), (0.3, 0.0), (0.5, 0.0), (2.75, 0.5), (5.0, 1.0), (9.0, 1.0)]
)
def test_depth_is_clipped_to_the_range_and_scaled(metres, shown):
    observation = observed(seen_from(Pose2(0, 0, 0), metres), CAMERA, HabitatTask(), 0, NO_IDS)
    assert observation["depth"].shape == (8, 8, 1)
    assert observation["depth"].dtype == np.float32
    assert (observation["depth"] == np.float32(shown)).all()


def test_depth_may_stay_in_metres():
    task = HabitatTask(normalize_depth=False)
    seen = [
        observed(seen_from(Pose2(0, 0, 0), m), CAMERA, task, 0, NO_IDS) for m in (0.1, 2.0, 9.0)
    ]
    assert [float(one["depth"].max()) for one in seen] == [0.5, 2.0, 5.0]
    space = spaces.Dict(sensor_spaces(CAMERA, task, 0))
    assert all(space.contains(one) for one in seen)


def test_an_observation_has_habitats_types_and_is_in_the_space():
    ids = np.full((8, 8), -1, np.int32)
    ids[0, 0] = 0
    goal = 4
    observation = observed(
        seen_from(Pose2(0, 0, -math.pi), ids=ids), CAMERA, ALL, goal, np.array([9, 0], np.int32)
    )
    assert spaces.Dict(sensor_spaces(CAMERA, ALL, 5)).contains(observation)
    assert {name: (value.dtype.name, value.shape) for name, value in observation.items()} == {
        "rgb": ("uint8", (8, 8, 3)),
        "depth": ("float32", (8, 8, 1)),
        "semantic": ("int32", (8, 8, 1)),
        "objectgoal": ("int64", (1,)),
        "compass": ("float32", (1,)),
        "gps": ("float32", (2,)),
    }
    assert observation["objectgoal"] == [goal]
    assert observation["semantic"][0, 0] == [9]
    assert (observation["semantic"] == 0).sum() == 63


def test_only_the_sensors_of_the_task_are_there():
    observation = observed(seen_from(Pose2(0, 0, 0)), CAMERA, HabitatTask(sensors=()), 0, NO_IDS)
    assert set(observation) == {"objectgoal", "compass", "gps"}


def test_instances_have_habitats_numbers(tmp_path):
    instances = scene_of(*room_boxes(), ("bed", (1, 1, 0), (2, 2, 1))).instances
    counted = [1, 2, 3, 4, 5, 6, 7, 0]
    named = [0, 1, 2, 3, 4, 5, 6, 0]
    assert semantic_ids_of(instances, "houses:7").tolist() == counted
    scan = tmp_path / "scan.glb"
    scan.touch()
    assert semantic_ids_of(instances, str(scan)).tolist() == named
    (tmp_path / "objects.json").touch()
    assert semantic_ids_of(instances, str(scan)).tolist() == counted
