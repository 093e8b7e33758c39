"""What a camera reaches of a map: the box around its view, and the rays of its pixels in voxels."""

import numpy as np
from jaxtyping import Float32, Float64

from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Transform


def reach(
    camera: PinholeCamera, camera_to_map: Transform, max_depth_m: float
) -> tuple[Float64[np.ndarray, "2"], Float64[np.ndarray, "2"]]:
    """Corners ``(x, y)`` of the box on the floor plan around all that a camera measures, metres."""
    u = np.array([0.0, camera.width, 0.0, camera.width])
    v = np.array([0.0, 0.0, camera.height, camera.height])
    points = np.concatenate([np.zeros((1, 3)), camera.unproject(u, v, max_depth_m)])
    flat = camera_to_map.apply(points)[:, :2]
    # Compiled arithmetic is single precision; a millimetre keeps its rounding inside the box.
    return flat.min(axis=0) - 1e-3, flat.max(axis=0) + 1e-3


def rays_in_voxels(
    camera: PinholeCamera,
    camera_to_map: Transform,
    corner: tuple[float, float, float],
    voxel: tuple[float, float, float],
) -> tuple[
    Float32[np.ndarray, "3"], Float32[np.ndarray, "width 3"], Float32[np.ndarray, "height 3"]
]:
    """The camera's position and, per column and row of pixels, the change per metre of depth.

    Args:
        camera: The camera.
        camera_to_map: Its pose.
        corner: Lower corner of the voxels ``(x, y, z)``, ``map`` frame, metres.
        voxel: Sides of a voxel along x, y and z, metres.

    Returns:
        All three as ``(column, row, layer)`` of voxels, for `count_points`.
    """
    per_voxel = 1.0 / np.array(voxel)
    turn = camera_to_map.rotation
    x, y = camera.ray_slopes()
    across = x[:, None] * (turn[:, 0] * per_voxel)
    down = y[:, None] * (turn[:, 1] * per_voxel) + turn[:, 2] * per_voxel
    start = (camera_to_map.translation - np.array(corner)) * per_voxel
    return start.astype(np.float32), across.astype(np.float32), down.astype(np.float32)
