import math

import numpy as np
import pytest

from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.transforms import Transform
from hypernav.search.mapping.top_down_kernels import (
    FLOOR,
    FREE,
    OCCUPIED,
    count_points,
    free_footprint,
)

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


@pytest.mark.parametrize(
    "robot", [(6.3, 9.8, 2.6), (0.4, 14.7, 3.2), (11.9, 0.1, 1.0), (5.5, 5.5, 0.0)]
)
def test_the_robot_frees_the_cells_whose_middles_it_stands_on(robot):
    shape = (12, 15)
    evidence = np.full((*shape, 4), 9, dtype=np.uint8)
    raised, seen = np.full(shape, 15, dtype=np.uint32), np.zeros(shape, dtype=np.uint8)
    bumps, drops = np.full(shape, 3, dtype=np.uint8), np.full(shape, 2, dtype=np.uint8)
    cells = np.full(shape, OCCUPIED, dtype=np.uint8)
    free_footprint(robot, (evidence, raised, seen, bumps, drops, cells))
    row, column, radius = robot
    rows, columns = np.indices(shape) + 0.5
    under = (np.hypot(rows - row, columns - column) <= radius) & (radius > 0.0)
    assert np.array_equal(cells, np.where(under, FREE, OCCUPIED))
    assert np.array_equal(seen, np.where(under, FLOOR, 0))
    assert np.array_equal(raised, np.where(under, 0, 15))
    assert np.array_equal(bumps, np.where(under, 0, 3))
    assert np.array_equal(drops, np.where(under, 0, 2))
    assert np.array_equal(evidence, np.where(under[..., None], 0, 9) * np.ones(4))
