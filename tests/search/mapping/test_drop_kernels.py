"""What a depth image shows below the floor, beside the projection of the camera itself."""

import numpy as np
import pytest

from box_views import view_of
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.mapping.top_down_kernels import height_at, shows_below

CAMERA = PinholeCamera.from_hfov(128, 96, 79.0)
ROBOT = Pose2(0.4, -0.3, 0.6)
DEEP_M = 0.3
"""How far below the floor a point shows that there is none, metres."""
GRID = np.stack(np.meshgrid(np.arange(0.5, 4.5, 0.15), np.arange(-1.0, 4.0, 0.15)), -1).reshape(
    -1, 2
)


def floor_with_pit(depth_m: float):
    """A floor with a pit of two metres by two."""
    (x0, y0), (x1, y1) = (1.6, 0.3), (3.6, 2.3)
    around = [((-9, -9), (9, y0)), ((-9, y1), (9, 9)), ((-9, y0), (x0, y1)), ((x1, y0), (9, y1))]
    floor = [((*low, -5.0), (*high, 0.0)) for low, high in around]
    pit = ((x0, y0, -5.0), (x1, y1, -depth_m))
    return view_of([*floor, pit], ROBOT, camera=CAMERA, pitch_deg=20.0)


def arguments(view, lower_m: float):
    lens = (*CAMERA.lens, 0.0, 5.0)
    fall = (float(view.camera_to_map.translation[2]), DEEP_M, 0.0, lower_m)
    return view.depth, lens, view.camera_to_map.inverse().rows, fall


def heights(view, u, v):
    """Height of what the pixels of image coordinates show, metres; infinite where nothing."""
    depth = view.depth[v.astype(int), u.astype(int)].astype(float)
    found = view.camera_to_map.apply(CAMERA.unproject(u, v, depth))[:, 2]
    return np.where(depth > 0.0, found, np.inf)


def test_the_height_of_a_pixel_is_that_of_its_point():
    view = floor_with_pit(0.5)
    depth, lens, pose, _ = arguments(view, np.inf)
    v, u = np.indices(view.depth.shape).reshape(2, -1) + 0.25
    found = [height_at(depth, lens, pose, *at) for at in zip(u, v, strict=True)]
    np.testing.assert_allclose(found, heights(view, u, v), atol=1e-5)


@pytest.mark.parametrize(
    ("depth_m", "lower_m", "answers"),
    [
        (0.0, np.inf, {0}),
        (0.25, np.inf, {0, 1}),
        (0.6, np.inf, {0, 1, 2}),
        (2.0, np.inf, {0, 1, 2}),
        (0.0, 1.0, {0}),
        (2.0, 1.0, {0, 1, 2}),
    ],
)
def test_a_drop_is_where_all_pixels_around_a_point_of_the_floor_show_what_is_below(
    depth_m: float, lower_m: float, answers: set[int]
):
    """Where lower ground is none, holes in the depth say nothing."""
    view = floor_with_pit(depth_m)
    view.depth[:, ::24] = 0.0
    depth, lens, pose, fall = arguments(view, lower_m)
    on_floor = np.column_stack([GRID, np.zeros(len(GRID))])
    at = CAMERA.project(view.camera_to_map.inverse().apply(on_floor))
    beside = np.array([(j, i) for i in (-1, 0, 1) for j in (-1, 0, 1)], dtype=float)
    found = set[int]()
    for (x, y), (u, v) in zip(GRID, at, strict=True):
        v = min(v, CAMERA.height - 1.5)
        if not (1.0 <= u < CAMERA.width - 1.0 and v >= 1.0):
            continue
        around = heights(view, *np.add(beside, (u, v)).T)
        expected = 0
        if around[4] < -DEEP_M / 2.0:
            is_hole = np.isinf(around) & (lower_m < np.inf)
            expected = 2 if ((around < -DEEP_M) | is_hole).all() else 1
        found.add(shows_below(depth, lens, pose, x, y, fall))
        assert shows_below(depth, lens, pose, x, y, fall) == expected
    assert found == answers


def test_level_ground_a_little_lower_is_no_drop():
    depth, lens, pose, fall = arguments(floor_with_pit(0.6), 1.0)
    assert [shows_below(depth, lens, pose, x, 0.5, fall) for x in (1.7, 1.75, 1.8)] == [0, 0, 0]
    depth, lens, pose, fall = arguments(floor_with_pit(0.6), 0.5)
    assert shows_below(depth, lens, pose, 1.75, 0.5, fall) == 2


def test_nothing_behind_the_camera_is_seen():
    view = floor_with_pit(2.0)
    assert shows_below(*arguments(view, np.inf)[:3], -3.0, -3.0, arguments(view, np.inf)[3]) == 0
