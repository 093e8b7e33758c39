"""The pinhole camera. Optical frame: x right, y down, z forward."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float, Float32, Float64, Int64

from hypernav.core.errors import CameraError
from hypernav.core.geometry.grid import is_within
from hypernav.core.geometry.transforms import Transform

_CENTRE = 0.5
"""Offset from the index of a pixel to the coordinate of its centre."""


@dataclass(frozen=True)
class PinholeCamera:
    """Intrinsics of an undistorted camera: projects points to pixels, and pixels to points.

    Pixels have indices (row and column); positions in the image have coordinates (u to the right, v
    down). The centre of a pixel has its indices plus one half as coordinates, and the image spans
    ``[0, width)``.

    Attributes:
        width: Width of the image, pixels.
        height: Height of the image, pixels.
        fx: Horizontal focal length, pixels.
        fy: Vertical focal length, pixels.
        cx: Column coordinate of the principal point, pixels.
        cy: Row coordinate of the principal point, pixels.
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
        """Camera with square pixels and a central principal point, as Habitat defines them."""
        if not 0.0 < hfov_deg < 180.0:
            raise CameraError(f"horizontal field of view must be in (0, 180)°, got {hfov_deg}°")
        f = width / 2.0 / math.tan(math.radians(hfov_deg) / 2.0)
        return PinholeCamera(width, height, f, f, width / 2.0, height / 2.0)

    @cached_property
    def lens(self) -> tuple[float, float, float, float]:
        """Focal lengths and principal point ``(fx, fy, cx, cy)``, pixels, for compiled loops."""
        return (float(self.fx), float(self.fy), float(self.cx), float(self.cy))

    @property
    def hfov(self) -> float:
        """Horizontal field of view, radians."""
        left = math.atan2(self.cx, self.fx)
        return left + math.atan2(self.width - self.cx, self.fx)

    def ray_slopes(self) -> tuple[Float64[np.ndarray, " width"], Float64[np.ndarray, " height"]]:
        """Change of x per metre of depth in every pixel column, and of y in every pixel row."""
        return self._slopes(np.arange(self.width) + _CENTRE, np.arange(self.height) + _CENTRE)

    def rays(self) -> Float64[np.ndarray, "height width 3"]:
        """Ray of every pixel in the optical frame, scaled so that z is 1 (not unit length)."""
        x, y = self.ray_slopes()
        rays = np.ones((self.height, self.width, 3))
        rays[..., 0] = x[None, :]
        rays[..., 1] = y[:, None]
        return rays

    def bearing_of(self, u: float) -> float:
        """Angle of an image column from the optical axis, radians, positive to the left."""
        return math.atan2(self.cx - u, self.fx)

    def unproject(
        self,
        u: Float[np.ndarray, "*#n"],
        v: Float[np.ndarray, "*#n"],
        depth: Float[np.ndarray, "*#n"] | float,
    ) -> Float64[np.ndarray, "*m 3"]:
        """Points in the optical frame, metres; the inverse of `project`.

        Args:
            u: Image coordinates to the right.
            v: Image coordinates down.
            depth: Metres along the optical axis.
        """
        x, y = self._slopes(u, v)
        return np.stack(np.broadcast_arrays(x * depth, y * depth, depth), axis=-1)

    def unproject_pixels(
        self,
        rows: Int64[np.ndarray, "*#n"],
        columns: Int64[np.ndarray, "*#n"],
        depth: Float[np.ndarray, "*#n"] | float,
    ) -> Float64[np.ndarray, "*m 3"]:
        """Points in the optical frame that the centres of pixels show, metres.

        Args:
            rows: Rows of the pixels.
            columns: Columns of the pixels.
            depth: Metres along the optical axis.
        """
        return self.unproject(columns + _CENTRE, rows + _CENTRE, depth)

    def project(self, points: Float64[np.ndarray, "n 3"]) -> Float64[np.ndarray, "n 2"]:
        """Pixel coordinates (u, v) of points in the optical frame; NaN where z is not positive."""
        z = np.where(points[:, 2] > 0.0, points[:, 2], np.nan)
        u = self.fx * points[:, 0] / z + self.cx
        v = self.fy * points[:, 1] / z + self.cy
        return np.stack([u, v], axis=1)

    def contains(self, pixels: Float64[np.ndarray, "n 2"]) -> Bool[np.ndarray, " n"]:
        """Which image coordinates (u, v) lie in the image; NaN does not."""
        return is_within(pixels[:, 0], self.width) & is_within(pixels[:, 1], self.height)

    def contains_columns(self, u: Float64[np.ndarray, " n"]) -> Bool[np.ndarray, " n"]:
        """Which image coordinates u lie between the left and right edges of the image."""
        return is_within(u, self.width)

    def reach(
        self, camera_to_map: Transform, max_depth_m: float
    ) -> tuple[Float64[np.ndarray, "2"], Float64[np.ndarray, "2"]]:
        """Corners ``(x, y)`` of the box on the floor plan around all that it measures, metres.

        Args:
            camera_to_map: Pose of the camera.
            max_depth_m: Upper limit of the sensor's range, metres.
        """
        u = np.array([0.0, self.width, 0.0, self.width])
        v = np.array([0.0, 0.0, self.height, self.height])
        points = np.concatenate([np.zeros((1, 3)), self.unproject(u, v, max_depth_m)])
        flat = camera_to_map.apply(points)[:, :2]
        # Compiled arithmetic is single precision; a millimetre keeps its rounding inside the box.
        return flat.min(axis=0) - 1e-3, flat.max(axis=0) + 1e-3

    def rays_in_voxels(
        self,
        camera_to_map: Transform,
        corner: tuple[float, float, float],
        voxel: tuple[float, float, float],
    ) -> tuple[
        Float32[np.ndarray, "3"], Float32[np.ndarray, "width 3"], Float32[np.ndarray, "height 3"]
    ]:
        """Its position and, per column and row of pixels, the change per metre of depth.

        Args:
            camera_to_map: Pose of the camera.
            corner: Lower corner of the voxels ``(x, y, z)``, ``map`` frame, metres.
            voxel: Sides of a voxel along x, y and z, metres.

        Returns:
            All three as ``(column, row, layer)`` of voxels, for compiled loops.
        """
        per_voxel = 1.0 / np.array(voxel)
        turn = camera_to_map.rotation
        x, y = self.ray_slopes()
        across = x[:, None] * (turn[:, 0] * per_voxel)
        down = y[:, None] * (turn[:, 1] * per_voxel) + turn[:, 2] * per_voxel
        start = (camera_to_map.translation - np.array(corner)) * per_voxel
        return start.astype(np.float32), across.astype(np.float32), down.astype(np.float32)

    def _slopes(
        self, u: Float[np.ndarray, "*n"], v: Float[np.ndarray, "*m"]
    ) -> tuple[Float64[np.ndarray, "*n"], Float64[np.ndarray, "*m"]]:
        """Slopes of the ray through image coordinates: x and y per metre of depth."""
        return (u - self.cx) / self.fx, (v - self.cy) / self.fy


def optical_to_base(height_m: float, pitch_deg: float = 0.0) -> Transform:
    """Pose of a camera on a robot: above the base's origin, looking forward.

    Args:
        height_m: Height above the floor, metres.
        pitch_deg: Downward tilt, degrees.

    Returns:
        The transform from the optical frame to the base frame (x forward, y left, z up).
    """
    forward = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
    c, s = math.cos(math.radians(pitch_deg)), math.sin(math.radians(pitch_deg))
    tilt = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    return Transform(tilt @ forward, np.array([0.0, 0.0, height_m]))
