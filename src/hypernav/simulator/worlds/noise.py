"""Noise of sensors, motion and odometry. All of it is off by default."""

import math

import cv2
import numpy as np
from jaxtyping import Float32

from hypernav.core.geometry.transforms import Pose2
from hypernav.simulator.worlds.config import NoiseConfig

_EDGE_JUMP = 0.1
"""Share by which neighbouring depths differ at an edge; ours."""


def noisy_depth(
    depth: Float32[np.ndarray, "height width"], config: NoiseConfig, rng: np.random.Generator
) -> Float32[np.ndarray, "height width"]:
    """Depth as a sensor with noise measures it.

    Args:
        depth: True depth, metres, 0 where there is no return.
        config: Kinds and sizes of noise.
        rng: Generator of the noise.

    Returns:
        Measured depth, metres, never negative; the same array if the sensor has no noise.
    """
    sensed = depth
    if config.depth_sigma_m > 0.0:
        noise = rng.standard_normal(depth.shape, dtype=np.float32)
        noise *= np.float32(config.depth_sigma_m) * depth * depth
        sensed = np.maximum(depth + noise, np.float32(0.0))
    if config.depth_edge_px > 0:
        kernel = np.ones((3, 3), dtype=np.uint8)
        jump = cv2.dilate(depth, kernel) - cv2.erode(depth, kernel)
        edge = (jump > _EDGE_JUMP * depth).astype(np.uint8)
        if config.depth_edge_px > 1:
            edge = cv2.dilate(edge, kernel, iterations=config.depth_edge_px - 1)
        sensed = np.where(edge > 0, np.float32(0.0), sensed)
    return sensed


def noisy_forward(length_m: float, config: NoiseConfig, rng: np.random.Generator) -> float:
    """Length of a forward step with noise, metres; never negative."""
    if config.forward_sigma == 0.0:
        return length_m
    return max(0.0, length_m * (1.0 + config.forward_sigma * float(rng.standard_normal())))


def noisy_turn(angle: float, config: NoiseConfig, rng: np.random.Generator) -> float:
    """Angle of a turn with noise, radians."""
    if config.turn_sigma_deg == 0.0:
        return angle
    return angle + math.radians(config.turn_sigma_deg) * float(rng.standard_normal())


def reported_motion(motion: Pose2, config: NoiseConfig, rng: np.random.Generator) -> Pose2:
    """A motion as odometry reports it.

    Args:
        motion: The true new pose in the frame of the pose before.
        config: Kinds and sizes of noise.
        rng: Generator of the noise.
    """
    x, y, yaw = motion.x, motion.y, motion.yaw
    length = math.hypot(x, y)
    if config.odometry_sigma > 0.0 and length > 0.0:
        dx, dy = config.odometry_sigma * length * rng.standard_normal(2)
        x, y = x + float(dx), y + float(dy)
    if config.odometry_turn_sigma_deg > 0.0 and (yaw != 0.0 or length > 0.0):
        yaw += math.radians(config.odometry_turn_sigma_deg) * float(rng.standard_normal())
    return Pose2(x, y, yaw)
