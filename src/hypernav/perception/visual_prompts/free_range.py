"""How far the floor is free in each direction, by the depth image alone.

Source: Goetting, Singh and Loquercio, "End-to-End Navigation with Vision-Language Models" (VLMnav),
2024, and its released code.
"""

import math

import numpy as np
from jaxtyping import Float64

from hypernav.core.embodiment import CameraConfig
from hypernav.core.observation import Observation
from hypernav.perception.visual_prompts.free_range_kernels import walk_lines

_FLOOR_M = (-0.24, 0.16)
"""Heights above the robot's floor between which a point is floor, metres (VLMnav's code)."""
_HEADINGS = 60
"""Number of directions that are looked at (VLMnav's code)."""
_SPREAD = 1.5
"""Angle between the outermost of them, in fields of view (VLMnav's code); those that the camera
doesn't see are not free."""
_BLOCKED_PX = 5
"""Number of pixels up to which a line over the floor is blocked at once (VLMnav's code)."""


def all_headings(camera: CameraConfig) -> Float64[np.ndarray, "n"]:
    """The directions that are looked at, radians from the robot's heading, from right to left."""
    half = _SPREAD * math.radians(camera.hfov_deg) / 2.0
    return np.linspace(-half, half, _HEADINGS)


def free_ranges(
    observation: Observation,
    headings: Float64[np.ndarray, "n"],
    camera: CameraConfig,
) -> Float64[np.ndarray, "n"]:
    """How far the floor is free along some headings.

    Floor right before the robot that the camera doesn't see counts as free if what it sees first
    is (ours: the original's camera looks down to its feet).

    Args:
        observation: Present frame.
        headings: Directions from the robot's heading, radians, positive to the left.
        camera: Range of the camera.

    Returns:
        Distances from the robot, metres; 0 where the way is blocked or not in the image.
    """
    to_base = observation.robot.to_transform().inverse() @ observation.camera_to_map
    lens = observation.camera
    return walk_lines(
        np.require(observation.depth, np.float32, ["C"]),
        (lens.fx, lens.fy, lens.cx, lens.cy),
        np.ascontiguousarray(to_base.rotation),
        float(to_base.translation[2]),
        np.ascontiguousarray(headings, dtype=np.float64),
        _FLOOR_M,
        camera.max_depth_m,
        (camera.min_depth_m, camera.max_depth_m),
        _BLOCKED_PX,
    )
