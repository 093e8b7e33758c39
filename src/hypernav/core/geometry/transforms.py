"""Rigid transforms, planar poses and straight lines. Conventions: docs/conventions.md."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float, Float64


def wrap_angle(angle: float) -> float:
    """The same angle in [-pi, pi), radians."""
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


@dataclass(frozen=True)
class Pose2:
    """Position and heading of a robot on the floor.

    Attributes:
        x: Position along the x axis, metres.
        y: Position along the y axis, metres.
        yaw: Heading, radians, counter-clockwise from the x axis.
    """

    x: float
    y: float
    yaw: float

    @property
    def xy(self) -> tuple[float, float]:
        """The position, metres."""
        return (self.x, self.y)

    def distance_to(self, x: float, y: float) -> float:
        """Straight distance to a point of the same frame, metres."""
        return math.hypot(x - self.x, y - self.y)

    def bearing_to(self, x: float, y: float) -> float:
        """Angle from the heading to a point, in [-pi, pi), positive to the left."""
        return wrap_angle(math.atan2(y - self.y, x - self.x) - self.yaw)

    def ahead(self, length_m: float) -> "Pose2":
        """The pose after so many metres straight on."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        return Pose2(self.x + length_m * c, self.y + length_m * s, self.yaw)

    def to_transform(self, z: float = 0.0) -> "Transform":
        """The transform from this pose's frame (x forward, y left, z up) to its parent frame."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        rotation = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        return Transform(rotation, np.array([self.x, self.y, z]))


@dataclass(frozen=True, eq=False)
class Transform:
    """A rigid transform, named for what it does: ``camera_to_map`` takes camera to map coordinates.

    Attributes:
        rotation: Right-handed rotation matrix.
        translation: Translation, metres.
    """

    rotation: Float64[np.ndarray, "3 3"]
    translation: Float64[np.ndarray, "3"]

    @staticmethod
    def identity() -> "Transform":
        """The identity transform."""
        return Transform(np.eye(3), np.zeros(3))

    @staticmethod
    def from_matrix(matrix: Float[np.ndarray, "4 4"]) -> "Transform":
        """Read a homogeneous matrix."""
        m = np.asarray(matrix, dtype=np.float64)
        return Transform(m[:3, :3].copy(), m[:3, 3].copy())

    @property
    def matrix(self) -> Float64[np.ndarray, "4 4"]:
        """The homogeneous matrix."""
        m = np.eye(4)
        m[:3, :3] = self.rotation
        m[:3, 3] = self.translation
        return m

    @cached_property
    def rows(self) -> tuple[float, ...]:
        """The upper three rows of the matrix, one after the other, for compiled loops.

        They are kept: rotation and translation must not be written to.
        """
        return tuple(self.matrix[:3].ravel().tolist())

    @property
    def yaw(self) -> float:
        """Heading of the transformed x axis in the target's xy plane, radians."""
        return math.atan2(self.rotation[1, 0], self.rotation[0, 0])

    def apply(self, points: Float[np.ndarray, "*n 3"]) -> Float[np.ndarray, "*n 3"]:
        """Transform points."""
        return points @ self.rotation.T + self.translation

    def inverse(self) -> "Transform":
        """The inverse transform."""
        return Transform(self.rotation.T.copy(), -self.rotation.T @ self.translation)

    def __matmul__(self, other: "Transform") -> "Transform":
        """Chain: ``(a_to_b.__matmul__)``, so that ``b_to_c @ a_to_b`` is ``a_to_c``."""
        return Transform(
            self.rotation @ other.rotation, self.rotation @ other.translation + self.translation
        )


def distances_to_segment(
    points: Float64[np.ndarray, "n 2"],
    start: Float64[np.ndarray, "2"],
    end: Float64[np.ndarray, "2"],
) -> Float64[np.ndarray, " n"]:
    """Distance of each point from the straight line between two others, in the unit of the points.

    Args:
        points: Points ``(x, y)``.
        start: One end of the line ``(x, y)``.
        end: Its other end; the same point makes the line that point.
    """
    along = end - start
    square = float(along @ along)
    shares = np.clip((points - start) @ along / square, 0.0, 1.0) if square > 0.0 else 0.0
    return np.linalg.norm(points - start - np.outer(shares, along), axis=1)
