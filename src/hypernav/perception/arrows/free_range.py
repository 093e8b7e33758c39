"""How far the floor is free in each direction, by the depth image alone.

Source: Goetting, Singh and Loquercio, "End-to-End Navigation with Vision-Language Models" (VLMnav),
2024, and its released code.
"""

import math

import numpy as np
from jaxtyping import Float64
from pydantic import Field

from hypernav.core.config import RoomConfig
from hypernav.core.embodiment import CameraConfig
from hypernav.core.observation import Observation
from hypernav.perception.arrows.free_range_kernels import walk_lines


class FreeRangeConfig(RoomConfig):
    """What counts as floor. Values are those of VLMnav's code unless said ours.

    Attributes:
        floor_below_m: Depth below the robot's floor down to which a point is floor, metres.
        floor_above_m: Height up to which a point is floor, metres.
        headings: Number of directions that are looked at.
        spread: Angle between the outermost of them, in fields of view; those that the camera
            doesn't see are not free.
        blocked_px: Number of pixels up to which a line over the floor is blocked at once.
    """

    floor_below_m: float = Field(default=0.24, ge=0.0, le=1.0)
    floor_above_m: float = Field(default=0.16, ge=0.0, le=1.0)
    headings: int = Field(default=60, ge=3, le=720)
    spread: float = Field(default=1.5, gt=0.0, le=3.0)
    blocked_px: int = Field(default=5, ge=0, le=100)

    def all_headings(self, camera: CameraConfig) -> Float64[np.ndarray, "n"]:
        """The directions, radians from the robot's heading, from right to left."""
        half = self.spread * math.radians(camera.hfov_deg) / 2.0
        return np.linspace(-half, half, self.headings)


def free_ranges(
    observation: Observation,
    headings: Float64[np.ndarray, "n"],
    config: FreeRangeConfig,
    camera: CameraConfig,
) -> Float64[np.ndarray, "n"]:
    """How far the floor is free along some headings.

    Floor right before the robot that the camera doesn't see counts as free if what it sees first
    is (ours: the original's camera looks down to its feet).

    Args:
        observation: Present frame.
        headings: Directions from the robot's heading, radians, positive to the left.
        config: What counts as floor.
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
        (-config.floor_below_m, config.floor_above_m),
        camera.max_depth_m,
        (camera.min_depth_m, camera.max_depth_m),
        config.blocked_px,
    )
