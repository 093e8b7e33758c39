"""What pixels show and what images should show, beside the projection of the camera itself."""

import math

import numpy as np

from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.search.memory.image_kernels import (
    are_near,
    count_visible,
    fan_of_view,
    points_under,
)

CAMERA = PinholeCamera(40, 30, 25.0, 31.0, 19.0, 16.0)
COS, SIN = math.cos(0.2), math.sin(0.2)
ROLLED = Transform(np.array([[COS, -SIN, 0.0], [SIN, COS, 0.0], [0.0, 0.0, 1.0]]), np.zeros(3))
POSE = Pose2(0.7, -0.4, 0.9).to_transform() @ optical_to_base(1.1, 25.0) @ ROLLED
RANDOM = np.random.default_rng(0)
DEPTH = RANDOM.choice([0.0, 1.0, 2.5, 4.0, 5.0, np.inf], (30, 40)).astype(np.float32)


def test_points_are_those_of_the_masked_pixels_with_depth():
    mask = RANDOM.uniform(size=DEPTH.shape) < 0.7
    for window, stride in (((3, 2, 38, 29), 1), ((0, 0, 40, 30), 3), ((5, 5, 5, 9), 2)):
        left, top, right, bottom = window
        part = np.zeros_like(mask)
        part[top:bottom:stride, left:right:stride] = True
        for masked, given in ((mask & part, mask), (part, None)):
            rows, columns = np.nonzero(masked & (DEPTH > 0.5) & (DEPTH < 5.0))
            points = CAMERA.unproject_pixels(rows, columns, DEPTH[rows, columns].astype(float))
            found = points_under(given, DEPTH, window, stride, (0.5, 5.0), CAMERA.lens, POSE.rows)
            np.testing.assert_allclose(found, POSE.apply(points), atol=1e-9)


def test_a_fan_reaches_as_far_as_the_columns_do():
    farthest = DEPTH[7]
    fan = fan_of_view(farthest, 3, CAMERA.lens, POSE.rows, (-2.0, -3.0), 0.2)
    columns = np.arange(0, 40, 3)
    z = np.where((farthest[columns] > 0.0) & (farthest[columns] < np.inf), farthest[columns], 0.0)
    aside = z * (columns + 0.5 - CAMERA.cx) / CAMERA.fx
    level = np.column_stack([aside, np.zeros(len(z)), z]) @ POSE.rotation.T + POSE.translation
    expected = np.floor((level[:, :2] - (-2.0, -3.0)) / 0.2)
    at = np.floor((POSE.translation[:2] - (-2.0, -3.0)) / 0.2)
    assert np.array_equal(fan, np.vstack([at, expected]))


def test_things_are_near_that_lie_ahead_and_are_large_enough():
    low = RANDOM.uniform(-4.0, 4.0, (400, 3))
    size = RANDOM.uniform(0.05, 1.5, (400, 3))
    robot, fx, most_m, least_px = (0.5, -0.7, 2.0), 100.0, 3.0, 25.0
    found = are_near(np.hstack([low, low + size]), robot, fx, most_m, least_px)
    away = (low + size / 2.0)[:, :2] - robot[:2]
    distance = np.linalg.norm(away, axis=1)
    across = np.minimum(size[:, :2].max(axis=1), size[:, 2])
    ahead = away @ (math.cos(robot[2]), math.sin(robot[2])) >= 0.0
    expected = ahead & (distance <= most_m) & (across * fx / distance >= least_px)
    assert np.array_equal(found, expected)
    assert 20 < expected.sum() < 200


def test_positions_are_visible_in_the_image_before_what_the_pixel_and_its_column_show():
    depth = RANDOM.choice([1.0, 2.5, 4.0], (30, 40)).astype(np.float32)
    farthest = RANDOM.choice([2.0, 4.0], 40).astype(np.float32)
    in_camera = RANDOM.uniform((-2.0, -2.0, -1.0), (2.0, 2.0, 5.0), (300, 3))
    points = POSE.apply(in_camera)
    heights = np.round(points[:, 2], 1)
    positions = np.stack([points[:, :2], points[:, :2] + (0.4, -0.3)], axis=1)
    limits, slack = (0.5, 4.5), (0.3, 0.1)
    found = count_visible(
        positions, heights, depth, farthest, CAMERA.lens, POSE.inverse().rows, limits, slack
    )
    expected = np.zeros((300, 2), dtype=int)
    for k in range(2):
        seen = POSE.inverse().apply(np.column_stack([positions[:, k], heights]))
        for i, (u, v) in enumerate(CAMERA.project(seen)):
            z = seen[i, 2]
            if limits[0] < z < limits[1] and CAMERA.contains(np.array([[u, v]]))[0]:
                is_open = farthest[int(u)] > z - slack[0] and depth[int(v), int(u)] > z - slack[1]
                expected[i] += (1, is_open)
    assert np.array_equal(found, expected)
    assert (expected[:, 0] > expected[:, 1]).any()
    assert expected[:, 1].any()


def test_what_the_pixel_or_its_column_shows_nearer_by_all_of_the_slack_is_hidden():
    camera = PinholeCamera(8, 8, 4.0, 4.0, 4.0, 4.0)
    ahead = np.array([1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0])  # 2 m ahead
    for shown_m, farthest_m, is_visible in ((1.75, 9.0, 0), (1.875, 9.0, 1), (9.0, 1.5, 0)):
        depth = np.full((8, 8), shown_m, dtype=np.float32)
        farthest = np.full(8, farthest_m, dtype=np.float32)
        found = count_visible(
            np.zeros((1, 1, 2)),
            np.zeros(1),
            depth,
            farthest,
            camera.lens,
            ahead,
            (0.5, 4.5),
            (0.5, 0.25),
        )
        assert found.tolist() == [[1, is_visible]]
