"""The pinhole camera. Optical frame: x right, y down, z forward."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from hypernav.core.errors import CameraError
from hypernav.core.geometry.transforms import Transform


@dataclass(frozen=True)
class PinholeCamera:
    """Intrinsics of an undistorted camera.

    Pixel centres lie at integer coordinates plus one half: the ray of pixel column ``u`` goes
    through ``u + 0.5``, and the image spans ``[0, width)``.

    Attributes:
        width: Pixels.
        height: Pixels.
        fx: Focal length, pixels.
        fy: Focal length, pixels.
        cx: Principal point, pixels.
        cy: Principal point, pixels.
    """

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float

    def __post_init__(self) -> None:
        """Reject a camera that cannot exist."""
        if self.width < 1 or self.height < 1:
            raise CameraError(f"image size must be positive, got {self.width}×{self.height}")
        if not (self.fx > 0 and self.fy > 0):
            raise CameraError(f"focal lengths must be positive, got fx {self.fx}, fy {self.fy}")

    @staticmethod
    def from_hfov(width: int, height: int, hfov_deg: float) -> "PinholeCamera":
        """Square pixels, principal point in the middle, as Habitat defines its cameras."""
        if not 0.0 < hfov_deg < 180.0:
            raise CameraError(f"horizontal field of view must be in (0, 180)°, got {hfov_deg}°")
        f = width / 2.0 / math.tan(math.radians(hfov_deg) / 2.0)
        return PinholeCamera(width, height, f, f, width / 2.0, height / 2.0)

    @property
    def hfov(self) -> float:
        """Horizontal field of view, radians."""
        left = math.atan2(self.cx, self.fx)
        return left + math.atan2(self.width - self.cx, self.fx)

    def rays(self) -> Float64[np.ndarray, "height width 3"]:
        """Ray of every pixel in the optical frame, scaled so that z is 1 (not unit length)."""
        x = (np.arange(self.width) + 0.5 - self.cx) / self.fx
        y = (np.arange(self.height) + 0.5 - self.cy) / self.fy
        rays = np.ones((self.height, self.width, 3))
        rays[..., 0] = x[None, :]
        rays[..., 1] = y[:, None]
        return rays

    def project(self, points: Float64[np.ndarray, "n 3"]) -> Float64[np.ndarray, "n 2"]:
        """Pixel coordinates (u, v) of points in the optical frame; NaN where z is not positive."""
        z = np.where(points[:, 2] > 0.0, points[:, 2], np.nan)
        u = self.fx * points[:, 0] / z + self.cx
        v = self.fy * points[:, 1] / z + self.cy
        return np.stack([u, v], axis=1)


def optical_to_base(height_m: float, pitch_deg: float = 0.0) -> Transform:
    """Where a camera sits on a robot: above the base's origin, looking forward.

    Args:
        height_m: Above the floor.
        pitch_deg: Downward tilt, degrees.

    Returns:
        The transform from the optical frame to the base frame (x forward, y left, z up).
    """
    forward = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
    c, s = math.cos(math.radians(pitch_deg)), math.sin(math.radians(pitch_deg))
    tilt = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    return Transform(tilt @ forward, np.array([0.0, 0.0, height_m]))
