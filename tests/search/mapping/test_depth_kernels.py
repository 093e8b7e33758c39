"""What a depth image shows of a position, beside the projection of the camera itself."""

import math

import numpy as np
import pytest

from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.search.mapping.top_down_kernels import in_sight, sees_floor, sees_through

CAMERA = PinholeCamera(40, 30, 25.0, 31.0, 19.0, 16.0)
NEAR, FAR = 0.5, 5.0
LENS = (*CAMERA.lens, NEAR, FAR)
SIZES, MARGINS = (0.2, 0.3, 0.1), (0.05, 0.02)
COS, SIN = math.cos(0.2), math.sin(0.2)
ROLLED = Transform(np.array([[COS, -SIN, 0.0], [SIN, COS, 0.0], [0.0, 0.0, 1.0]]), np.zeros(3))
POSE = Pose2(0.7, -0.4, 0.9).to_transform() @ optical_to_base(1.1, 25.0) @ ROLLED
ROWS = POSE.inverse().rows
RANDOM = np.random.default_rng(0)
# Some measure nothing, some lie beyond the range, some are codes.
DEPTH = RANDOM.choice([0.0, 2.0, 3.0, 4.0, 7.0, 14.0, 16.0], (30, 40)).astype(np.float32)
POINTS = POSE.apply(RANDOM.uniform((-3.0, -3.0, -1.0), (3.0, 3.0, 6.0), (500, 3)))


def in_camera(point) -> tuple[float, float, float]:
    """Image coordinates and depth of a position."""
    seen = POSE.inverse().apply(np.array([point]))
    ((u, v),) = CAMERA.project(seen)
    return float(u), float(v), float(seen[0, 2])


def ends(u: float, v: float, limits: tuple[float, float], depth=DEPTH) -> float:
    """Depth of a pixel, if it lies within these limits."""
    inside = 0.0 <= u < CAMERA.width and 0.0 <= v < CAMERA.height
    d = depth[int(v), int(u)] if inside else 0.0
    return d if limits[0] < d < limits[1] else 0.0


def test_a_voxel_is_seen_through_if_the_rays_of_its_middle_and_corners_end_behind_it():
    depth = DEPTH.copy()
    depth[:, 5:] = np.where(RANDOM.uniform(size=(30, 35)) < 0.95, 14.0, depth[:, 5:])
    found = []
    for x, y, h in POINTS:
        u, v, z = in_camera((x, y, h))
        expected = False
        if SIZES[0] < z < FAR:
            du, dv = CAMERA.fx * 0.1 / z, CAMERA.fy * 0.15 / z
            at = [(u, v), *((u + i * du, v + j * dv) for i in (-1, 1) for j in (-1, 1))]
            behind = z + MARGINS[0] + MARGINS[1] * z
            # Up to three times the range a ray surely came as far; exactly the range is a code.
            expected = all(ends(*one, (NEAR, 15.0), depth) > behind for one in at)
        found.append(sees_through(depth, LENS, ROWS, x, y, h, SIZES, MARGINS))
        assert found[-1] == expected
    assert 5 < sum(found) < 495


@pytest.mark.parametrize("heights", [(0.0,), (0.0, 0.4, 0.8)])
def test_floor_is_free_at_the_lowest_height_that_the_image_shows(heights):
    found = set[int]()
    for x, y, _ in POINTS:
        expected = 0
        for k, h in enumerate(heights):
            u, v, z = in_camera((x, y, h))
            if z >= FAR:
                break
            if z > 0.0 and v < CAMERA.height:
                expected = (1 if k else 2) if ends(u, v, (NEAR, FAR)) > z else 0
                break
        found.add(sees_floor(DEPTH, LENS, ROWS, x, y, np.array(heights)))
        assert sees_floor(DEPTH, LENS, ROWS, x, y, np.array(heights)) == expected
    assert found == ({0, 2} if len(heights) == 1 else {0, 1, 2})


def test_a_column_is_in_sight_if_one_of_its_ends_is_or_the_image_lies_between_them():
    found = []
    for x, y, _ in POINTS:
        ends_at = [in_camera((x, y, h)) for h in (0.1, 1.8)]
        before = [(u, z) for u, _, z in ends_at if z > 0.0]
        expected = any(0.0 <= u < CAMERA.width and z < FAR for u, z in before)
        sides = sorted((u >= CAMERA.width) - (u < 0.0) for u, _ in before)
        found.append(in_sight(CAMERA.width, LENS, ROWS, x, y, 0.1, 1.8))
        assert found[-1] == (expected or sides == [-1, 1])
    assert 20 < sum(found) < 480
