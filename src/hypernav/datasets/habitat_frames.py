"""Conversions between Habitat's frame (y up, agents look along -z) and the z-up scene frame.

Yaw is measured from the x axis.

A position ``(x, y, z)`` of Habitat is ``(x, -z, y)`` here, as for glTF files.
"""

import math
from collections.abc import Sequence

import numpy as np
from jaxtyping import Float64

from hypernav.core.errors import EpisodeError
from hypernav.core.geometry.transforms import Pose2, wrap_angle


def positions_from_habitat(
    positions: Float64[np.ndarray, "n 3"],
) -> Float64[np.ndarray, "n 3"]:
    """Positions in the z-up scene frame, metres."""
    return np.stack([positions[:, 0], -positions[:, 2], positions[:, 1]], axis=1)


def positions_to_habitat(
    positions: Float64[np.ndarray, "n 3"],
) -> Float64[np.ndarray, "n 3"]:
    """Positions in Habitat's y-up frame, metres."""
    return np.stack([positions[:, 0], positions[:, 2], -positions[:, 1]], axis=1)


def pose_from_habitat(position: Sequence[float], rotation: Sequence[float]) -> tuple[Pose2, float]:
    """An agent's pose on the floor.

    Args:
        position: ``[x, y, z]``, Habitat's frame.
        rotation: Quaternion ``[x, y, z, w]``, not necessarily of unit length.

    Returns:
        The pose in the z-up scene frame and the floor's height there.

    Raises:
        EpisodeError: The rotation is zero or looks straight up or down.
    """
    x, y, z, w = rotation
    # The viewing direction (0, 0, -1) rotated by the quaternion, times its squared length.
    forward_x = -2.0 * (x * z + w * y)
    forward_z = -(w * w - x * x - y * y + z * z)
    if math.hypot(forward_x, forward_z) < 1e-6:
        raise EpisodeError(
            f"a rotation must not look straight up or down, got the quaternion {list(rotation)}"
        )
    yaw = wrap_angle(math.atan2(-forward_z, forward_x))
    return Pose2(float(position[0]), -float(position[2]), yaw), float(position[1])


def pose_to_habitat(
    pose: Pose2, floor_z: float
) -> tuple[tuple[float, float, float], tuple[float, float, float, float]]:
    """A pose on the floor as Habitat's position and quaternion ``[x, y, z, w]``."""
    half = (pose.yaw - math.pi / 2.0) / 2.0
    return (pose.x, floor_z, -pose.y), (0.0, math.sin(half), 0.0, math.cos(half))
