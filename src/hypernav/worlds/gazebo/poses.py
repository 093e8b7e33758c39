"""Poses in Gazebo's format."""

import math
import xml.etree.ElementTree as ElementTree

import numpy as np
from jaxtyping import Float64

from hypernav.worlds.collada.triangles import numbers_of

Matrix = Float64[np.ndarray, "4 4"]


def matrix_of(pose: ElementTree.Element | None) -> Matrix:
    """The transform of a pose to what it is relative to; that of none is no motion.

    Args:
        pose: An element ``pose``: x, y, z and roll, pitch, yaw, or a quaternion x, y, z, w.

    Raises:
        ValueError: It hasn't the numbers that it needs.
    """
    matrix = np.eye(4)
    if pose is None or not (pose.text or "").strip():
        return matrix
    values = numbers_of(pose.text)
    if pose.get("rotation_format") == "quat_xyzw":
        if len(values) != 7:
            raise ValueError(f"a pose has {len(values)} numbers, expected 7")
        matrix[:3, :3] = _from_quaternion(values[3:])
    elif len(values) == 6:
        angles = np.radians(values[3:]) if pose.get("degrees") in ("true", "1") else values[3:]
        matrix[:3, :3] = _from_angles(*angles.tolist())
    else:
        raise ValueError(f"a pose has {len(values)} numbers, expected 6")
    matrix[:3, 3] = values[:3]
    return matrix


def frame_of(pose: ElementTree.Element | None) -> str:
    """Name of what a pose is relative to; empty for what the element stands in."""
    name = "" if pose is None else pose.get("relative_to") or pose.get("frame") or ""
    return "" if name in ("world", "__model__", "/map") else name


def _from_angles(roll: float, pitch: float, yaw: float) -> Float64[np.ndarray, "3 3"]:
    about_x, about_y, about_z = ((math.cos(a), math.sin(a)) for a in (roll, pitch, yaw))
    (c, s), (d, t), (e, u) = about_x, about_y, about_z
    return (
        np.array([[e, -u, 0.0], [u, e, 0.0], [0.0, 0.0, 1.0]])
        @ np.array([[d, 0.0, t], [0.0, 1.0, 0.0], [-t, 0.0, d]])
        @ np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
    )


def _from_quaternion(quaternion: Float64[np.ndarray, "4"]) -> Float64[np.ndarray, "3 3"]:
    x, y, z, w = quaternion / max(float(np.linalg.norm(quaternion)), 1e-12)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
