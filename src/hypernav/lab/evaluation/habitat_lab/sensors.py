"""Observations of habitat-lab's ObjectNav task, made from ours.

Source: habitat-lab, ``habitat/sims/habitat_simulator/habitat_simulator.py`` (cameras),
``habitat/tasks/nav/nav.py`` (``EpisodicGPSSensor``, ``EpisodicCompassSensor``) and
``habitat/tasks/nav/object_nav_task.py`` (``ObjectGoalSensor``).
"""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from gymnasium import spaces
from jaxtyping import Float32, Int32

from hypernav.core.embodiment import CameraConfig
from hypernav.core.observation import Observation
from hypernav.core.world import Instance
from hypernav.lab.evaluation.habitat_lab.task import HabitatTask
from hypernav.simulator.worlds.scenes.loading import OBJECTS_FILE

_ANNOTATED = re.compile(r"_(\d+)$", re.ASCII)


def sensor_spaces(
    camera: CameraConfig, task: HabitatTask, largest_goal: int
) -> dict[str, spaces.Space[Any]]:
    """The space of every sensor's observations.

    Args:
        camera: The camera with the range of its depth.
        task: Sensors of the task.
        largest_goal: Largest number of a category.
    """
    size = (camera.height, camera.width)
    scaled = (0.0, 1.0) if task.normalize_depth else (camera.min_depth_m, camera.max_depth_m)
    cameras: dict[str, spaces.Space[Any]] = {
        "rgb": spaces.Box(0, 255, (*size, 3), np.uint8),
        "depth": spaces.Box(*scaled, (*size, 1), np.float32),
        "semantic": spaces.Box(0, np.iinfo(np.int32).max, (*size, 1), np.int32),
    }
    far = float(np.finfo(np.float32).max)
    return {name: cameras[name] for name in task.sensors} | {
        "objectgoal": spaces.Box(0, largest_goal, (1,), np.int64),
        "compass": spaces.Box(-np.pi, np.pi, (1,), np.float32),
        "gps": spaces.Box(-far, far, (2,), np.float32),
    }


def observed(
    seen: Observation,
    camera: CameraConfig,
    task: HabitatTask,
    goal: int,
    semantic_ids: Int32[np.ndarray, "instances_and_nothing"],
) -> dict[str, Any]:
    """What habitat-lab's sensors show.

    Args:
        seen: Our observation, its depth not clipped to the sensor's range.
        camera: The camera with the range of its depth.
        task: Sensors of the task.
        goal: Number of the goal's category.
        semantic_ids: Result of `semantic_ids_of`, for the sensor ``semantic``.
    """
    images: dict[str, Any] = {}
    if "rgb" in task.sensors:
        images["rgb"] = seen.rgb.copy()
    if "depth" in task.sensors:
        images["depth"] = _depth(seen.depth, camera, normalized=task.normalize_depth)
    if "semantic" in task.sensors and seen.truth is not None:
        images["semantic"] = semantic_ids[seen.truth.ids][:, :, np.newaxis]
    robot = seen.robot
    return images | {
        "objectgoal": np.array([goal], dtype=np.int64),
        "compass": np.array([robot.yaw], dtype=np.float32),
        # Forward and right as seen from the start.
        "gps": np.array([robot.x, -robot.y], dtype=np.float32),
    }


def semantic_ids_of(
    instances: Sequence[Instance], scene_id: str
) -> Int32[np.ndarray, "instances_and_nothing"]:
    """habitat-sim's number for each instance; the last one is for pixels without an instance.

    In a file it is the number at the end of the object's name, which the annotation gives, and 0 if
    there is none. In generated buildings, exported or not, it is the number of the instance,
    counted from 1.

    Args:
        instances: All instances of the scene; an instance's id is its index.
        scene_id: Name or file of the scene.
    """
    file = Path(scene_id)
    if not file.is_file() or (file.parent / OBJECTS_FILE).is_file():
        return np.array([*range(1, len(instances) + 1), 0], dtype=np.int32)
    found = (_ANNOTATED.search(instance.name) for instance in instances)
    return np.array([*(0 if match is None else int(match[1]) for match in found), 0], np.int32)


def _depth(
    depth: Float32[np.ndarray, "height width"], camera: CameraConfig, *, normalized: bool
) -> Float32[np.ndarray, "height width 1"]:
    nearest, farthest = np.float32(camera.min_depth_m), np.float32(camera.max_depth_m)
    clipped = np.clip(depth, nearest, farthest)[:, :, np.newaxis]
    return (clipped - nearest) / (farthest - nearest) if normalized else clipped
