"""Values of views in a grid, beside plain geometry."""

import math

import numpy as np
import pytest

from hypernav.search.rivals.vlfm.value_kernels import (
    fuse_view,
    medians_around,
    reach_of_columns,
)

RANDOM = np.random.default_rng(0)


def test_a_column_reaches_as_far_as_its_farthest_measured_pixel():
    depth = RANDOM.choice([0.0, 1.0, 3.0, 5.0, 9.0], (6, 12)).astype(np.float32)
    forward = RANDOM.uniform(0.5, 1.0, 6).astype(np.float32)
    measured = np.where((depth > 0.5) & (depth < 5.0), depth, 0.0)
    expected = (measured * forward[:, None]).max(axis=0)
    assert reach_of_columns(depth, forward, 0.5, 5.0) == pytest.approx(expected)


def test_a_view_counts_by_its_confidence_where_it_shows_a_cell():
    yaw, eye, corner, size = 0.7, (0.3, -0.2), (-2.0, -3.0), 0.25
    focal, centre, width = 12.0, 8.5, 16
    reach = RANDOM.uniform(0.5, 4.0, width).astype(np.float32)
    weights = RANDOM.uniform(0.1, 1.0, width).astype(np.float32)
    before = RANDOM.uniform(size=(24, 20)).astype(np.float32)
    sure = RANDOM.choice([0.0, 0.4, 0.9], (24, 20)).astype(np.float32)
    values, confidences = before.copy(), sure.copy()
    fuse_view(
        values, confidences, corner, size, (*eye, math.cos(yaw), math.sin(yaw)),
        (focal, centre), reach, weights, 0.8, 0.35,
    )  # fmt: skip
    changed = 0
    for i, j in np.ndindex(before.shape):
        x, y = corner[0] + (j + 0.5) * size - eye[0], corner[1] + (i + 0.5) * size - eye[1]
        ahead = math.hypot(x, y) * math.cos(math.atan2(y, x) - yaw)
        right = -math.hypot(x, y) * math.sin(math.atan2(y, x) - yaw)
        u = centre + focal * right / ahead if ahead > 0.0 else -1.0
        value, confidence = before[i, j], sure[i, j]
        if 0.0 <= u < width and ahead <= reach[int(u)]:
            new = weights[int(u)]
            if new >= 0.35 or new >= confidence:
                changed += 1
                value = (value * confidence + 0.8 * new) / (confidence + new)
                confidence = (confidence**2 + new**2) / (confidence + new)
        assert (values[i, j], confidences[i, j]) == pytest.approx((value, confidence), abs=1e-5)
    assert 20 < changed < 200


@pytest.mark.parametrize("radius", [0.4, 1.0, 2.7])
def test_the_median_is_that_of_the_known_values_within_the_radius(radius: float):
    values = RANDOM.uniform(size=(14, 17)).astype(np.float32)
    known = (RANDOM.uniform(size=values.shape) < 0.5).astype(np.float32)
    centres = RANDOM.uniform((-2.0, -2.0), (16.0, 19.0), (60, 2))
    rows, columns = np.indices(values.shape) + 0.5
    expected = []
    for row, column in centres:
        near = (np.hypot(rows - row, columns - column) <= radius) & (known > 0.0)
        expected.append(float(np.median(values[near])) if near.any() else -1.0)
    assert medians_around(values, known, centres, radius) == pytest.approx(expected)
