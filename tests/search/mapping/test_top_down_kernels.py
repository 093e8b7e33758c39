import math

import numpy as np
import pytest

from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.transforms import Transform
from hypernav.search.mapping.top_down_kernels import count_points

CAMERA = PinholeCamera.from_hfov(24, 18, 79.0)
NEAR, FAR = np.float32(0.5), np.float32(5.0)
COLUMNS, LAYERS = 240, 17
CORNER, VOXEL = (-6.0, -6.0, 0.1), (0.05, 0.05, 0.05)


def rolled(angle: float) -> Transform:
    """A turn around the optical axis."""
    cos, sin = math.cos(angle), math.sin(angle)
    turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    return Transform(turn, np.zeros(3))


@pytest.mark.parametrize("height_m", [0.3, 0.88, 1.4])
@pytest.mark.parametrize("pitch_deg", [-30.0, 0.0, 20.0])
@pytest.mark.parametrize("roll_deg", [0.0, 8.0, -25.0])
def test_every_measured_point_in_the_height_band_is_counted(
    height_m: float, pitch_deg: float, roll_deg: float
):
    pose = optical_to_base(height_m, pitch_deg) @ rolled(math.radians(roll_deg))
    depth = np.random.default_rng(0).uniform(0.0, 6.0, (18, 24)).astype(np.float32)
    depth[:, ::3] = np.nextafter(NEAR, FAR)  # as near as anything is measured
    rays = CAMERA.rays_in_voxels(pose, CORNER, VOXEL)
    counts = np.zeros(COLUMNS * COLUMNS * LAYERS, dtype=np.uint16)
    touched = np.zeros(depth.size, dtype=np.int32)

    n = count_points(depth, NEAR, FAR, *rays, COLUMNS, LAYERS, counts, touched)

    start, across, down = rays
    voxels = start + depth[..., None] * (down[:, None] + across[None])
    is_measured = (depth > NEAR) & (depth < FAR)
    in_band = is_measured & (voxels[..., 2] >= 0.0) & (voxels[..., 2] < LAYERS)
    column, row, layer = voxels[in_band].astype(np.int64).T
    expected = np.bincount((row * COLUMNS + column) * LAYERS + layer, minlength=counts.size)
    assert np.array_equal(counts, expected)
    assert set(touched[:n].tolist()) == set(np.flatnonzero(expected).tolist())
