"""Where the ends of moves are marked in the camera image."""

import math

import numpy as np
from jaxtyping import Float64

from hypernav.core.observation import Observation

_STEP_M = 0.05
_FARTHEST_M = 20.0
_MARGIN = 0.04
"""Distance of a mark from the edges of the image, as a share of its sides (VLMnav's code)."""


def mark_of(
    observation: Observation, heading: float, length_m: float, *, slide: bool
) -> tuple[float, float] | None:
    """Image coordinates of the end of a move over the floor; None if it can't be marked.

    Args:
        observation: Frame whose image is marked.
        heading: Direction of the move from the robot's heading, radians.
        length_m: Length of the move, metres.
        slide: Whether the mark of an end below the image is slid into it.
    """
    farthest = _FARTHEST_M if slide else length_m
    distances = np.arange(length_m, farthest + _STEP_M / 2.0, _STEP_M)
    pixels = floor_pixels(observation, heading, distances)
    camera = observation.camera
    inner = np.array([camera.width, camera.height]) * _MARGIN
    outer = np.array([camera.width, camera.height]) - inner
    inside = ((pixels >= inner) & (pixels <= outer)).all(axis=1)
    if not inside.any():
        return None
    u, v = pixels[int(inside.argmax())]
    return float(u), float(v)


def floor_pixels(
    observation: Observation, heading: float, distances_m: Float64[np.ndarray, "n"]
) -> Float64[np.ndarray, "n 2"]:
    """Image coordinates of points on the floor, NaN behind the camera.

    Args:
        observation: Frame whose camera sees them.
        heading: Direction from the robot's heading, radians.
        distances_m: Distances from the robot, metres.
    """
    robot = observation.robot
    angle = robot.yaw + heading
    x = robot.x + distances_m * math.cos(angle)
    y = robot.y + distances_m * math.sin(angle)
    points = np.stack([x, y, np.zeros_like(x)], axis=1)
    return observation.camera.project(observation.camera_to_map.inverse().apply(points))
