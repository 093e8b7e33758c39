"""How far the floor is free in each direction, by depth alone, and what was explored.

Source: Goetting, Singh and Loquercio, "End-to-End Navigation with Vision-Language Models" (VLMnav),
2024, and its released code.
"""

import math

import cv2
import numpy as np
from jaxtyping import Bool, Float64

from hypernav.core.embodiment import CameraConfig
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.observation import Observation
from hypernav.perception.visual_prompts.free_range_kernels import walk_lines
from hypernav.perception.visual_prompts.proposals import MOST_MOVE_M

_FLOOR_M = (-0.24, 0.16)
"""Heights above the robot's floor between which a point is floor, metres (VLMnav's code)."""
_HEADINGS = 60
"""Number of directions that are examined (VLMnav's code)."""
_SPREAD = 1.5
"""Angle between the outermost of them, in fields of view (VLMnav's code); those that the camera
doesn't see are not free."""
_BLOCKED_PX = 5
"""Length in the image, pixels, up to which a line counts as blocked (VLMnav's code)."""
_CELL_M = 0.05
"""Side of a cell, metres; ours: the original draws 100 pixels a metre."""
_SIDE_M = 50.0
_ALONG_M = np.array([-0.02, -0.01, 0.0, 0.01])
_PROBES_M = np.array([(x, 0.0) for x in _ALONG_M] + [(0.0, y) for y in _ALONG_M])
"""Positions at and beside a point, metres: four along each axis (VLMnav's code)."""
_SEEN_PROBES = 3
"""Number of these that must be explored for the point to be explored (VLMnav's code)."""
_WIDTH_M = 0.6
"""Width of the strip of floor that one image explores, metres (VLMnav's code)."""
_REACH = 0.8
"""Length of the strip, as a share of the free range (VLMnav's code)."""


def all_headings(camera: CameraConfig) -> Float64[np.ndarray, "n"]:
    """The examined directions, radians from the robot's heading, from right to left."""
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
        camera.depth_limits_m,
        _BLOCKED_PX,
    )


class RayMemory:
    """Strips of floor that images explored, in a square of 50 m around the first robot position.

    Beyond that nothing counts as explored.
    """

    def __init__(self) -> None:
        """Begin without any strip."""
        side = round(_SIDE_M / _CELL_M)
        self._explored = np.zeros((side, side), dtype=np.uint8)
        self._corner: Float64[np.ndarray, 2] | None = None

    def look(
        self, robot: Pose2, headings: Float64[np.ndarray, "n"], free_m: Float64[np.ndarray, "n"]
    ) -> Bool[np.ndarray, " n"]:
        """Add the strips of the present image, then tell which directions lead to explored floor.

        Args:
            robot: Pose of the robot, ``map`` frame.
            headings: Directions from its heading, radians, positive to the left.
            free_m: Free ranges in these directions, metres.

        Returns:
            Whether each direction is explored at four fifths of its range, by this image or others.
        """
        if self._corner is None:
            self._corner = np.array(robot.xy) - _SIDE_M / 2.0
        angles = robot.yaw + headings
        towards = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        reaches = _REACH * free_m
        here = np.array(robot.xy)
        ends = self._cells(here + towards * np.minimum(reaches, MOST_MOVE_M)[:, None])
        start = tuple(int(number) for number in self._cells(here[None])[0])
        thickness = max(round(_WIDTH_M / _CELL_M), 1)
        for end in ends[free_m > 0.0]:
            cv2.line(self._explored, start, (int(end[0]), int(end[1])), 1, thickness)
        return self._is_explored(here + towards * reaches[:, None])

    def _is_explored(self, points: Float64[np.ndarray, "n 2"]) -> Bool[np.ndarray, " n"]:
        cells = self._cells((points[:, None] + _PROBES_M).reshape(-1, 2))
        side = len(self._explored)
        inside = ((cells >= 0) & (cells < side)).all(axis=1)
        seen = np.zeros(len(cells), dtype=bool)
        seen[inside] = self._explored[cells[inside, 1], cells[inside, 0]] > 0
        return seen.reshape(-1, len(_PROBES_M)).sum(axis=1) >= _SEEN_PROBES

    def _cells(self, points: Float64[np.ndarray, "n 2"]):
        assert self._corner is not None
        return np.floor((points - self._corner) / _CELL_M).astype(np.int64)
