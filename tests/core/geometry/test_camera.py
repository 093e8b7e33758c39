import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.core.errors import CameraError
from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.transforms import Pose2

CAMERA = PinholeCamera(64, 48, 50.0, 40.0, 30.0, 25.0)


def test_the_optical_frame_on_a_robot_looks_forward():
    camera_to_base = optical_to_base(0.88)
    ahead, right, down = camera_to_base.apply(np.array([[0, 0, 2.0], [1.0, 0, 0], [0, 1.0, 0]]))
    np.testing.assert_allclose(ahead, [2.0, 0.0, 0.88], atol=1e-12)
    np.testing.assert_allclose(right, [0.0, -1.0, 0.88], atol=1e-12)
    np.testing.assert_allclose(down, [0.0, 0.0, -0.12], atol=1e-12)


def test_a_pitched_camera_looks_down():
    point = optical_to_base(1.0, pitch_deg=45.0).apply(np.array([[0.0, 0.0, math.sqrt(2)]]))
    np.testing.assert_allclose(point, [[1.0, 0.0, 0.0]], atol=1e-12)


@given(st.integers(2, 900), st.integers(2, 900), st.floats(20, 150))
def test_the_field_of_view_that_goes_in_comes_out(width, height, hfov_deg):
    camera = PinholeCamera.from_hfov(width, height, hfov_deg)
    assert math.degrees(camera.hfov) == pytest.approx(hfov_deg)


def test_projecting_a_ray_gives_its_pixel_centre():
    camera = PinholeCamera.from_hfov(64, 48, 79.0)
    pixels = camera.project(camera.rays().reshape(-1, 3) * 2.5)
    v, u = np.mgrid[0:48, 0:64]
    np.testing.assert_allclose(pixels[:, 0], u.ravel() + 0.5, atol=1e-9)
    np.testing.assert_allclose(pixels[:, 1], v.ravel() + 0.5, atol=1e-9)


def test_points_behind_the_camera_have_no_pixel():
    camera = PinholeCamera.from_hfov(64, 48, 79.0)
    assert np.isnan(camera.project(np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 0.0]]))).all()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [((0, 48, 79.0), "positive"), ((64, 48, 0.0), "0, 180"), ((64, 48, 180.0), "0, 180")],
)
def test_impossible_cameras_are_refused(arguments, words):
    with pytest.raises(CameraError, match=words):
        PinholeCamera.from_hfov(*arguments)


@given(st.floats(-20, 100), st.floats(-20, 100), st.floats(0.1, 50))
def test_unprojecting_undoes_projecting(u, v, depth_m):
    point = CAMERA.unproject(np.array([u]), np.array([v]), depth_m)
    assert point[0, 2] == depth_m
    np.testing.assert_allclose(CAMERA.project(point), [[u, v]], atol=1e-9)


def test_a_pixel_shows_what_its_ray_meets():
    rows, columns = np.indices((48, 64))
    depth = np.linspace(0.5, 5.0, 64 * 48).reshape(48, 64)
    points = CAMERA.unproject_pixels(rows, columns, depth)
    np.testing.assert_allclose(points, CAMERA.rays() * depth[..., None], atol=1e-12)
    x, y = CAMERA.ray_slopes()
    np.testing.assert_array_equal(CAMERA.rays()[7, :, 0], x)
    np.testing.assert_array_equal(CAMERA.rays()[:, 7, 1], y)


def test_rows_and_columns_may_be_given_apart():
    rows, columns = np.arange(48), np.arange(64)
    apart = CAMERA.unproject_pixels(rows[:, None], columns[None, :], 2.0)
    np.testing.assert_array_equal(apart, CAMERA.rays() * 2.0)


@given(st.floats(-3.1, 3.1), st.floats(-60.0, 90.0), st.floats(0.1, 10.0))
def test_all_that_a_camera_measures_lies_within_its_reach_and_fills_it(yaw, pitch_deg, most_m):
    camera_to_map = Pose2(3.0, -2.0, yaw).to_transform() @ optical_to_base(0.9, pitch_deg)
    low, high = CAMERA.reach(camera_to_map, most_m)
    u, v, depth_m = np.meshgrid([0.0, 20.0, 64.0], [0.0, 25.0, 48.0], [0.0, 0.5 * most_m, most_m])
    shown = camera_to_map.apply(CAMERA.unproject(u, v, depth_m).reshape(-1, 3))[:, :2]
    np.testing.assert_allclose(shown.min(axis=0) - low, 0.001, atol=1e-9)
    np.testing.assert_allclose(high - shown.max(axis=0), 0.001, atol=1e-9)


@given(st.floats(0.1, 63.9))
def test_the_bearing_of_a_column_is_that_of_what_it_shows(u):
    x, _, z = CAMERA.unproject(np.array([u]), np.array([20.0]), 3.0)[0]
    assert CAMERA.bearing_of(u) == pytest.approx(math.atan2(-x, z))
    assert CAMERA.bearing_of(CAMERA.cx) == 0.0


def test_an_image_begins_at_0_and_ends_before_its_size():
    pixels = np.array([[0.0, 0.0], [63.99, 47.99], [64.0, 5.0], [5.0, 48.0], [-0.01, 5.0]])
    assert CAMERA.contains(pixels).tolist() == [True, True, False, False, False]
    assert CAMERA.contains_columns(pixels[:, 0]).tolist() == [True, True, False, True, False]


def test_what_lies_behind_the_camera_is_not_in_the_image():
    behind = CAMERA.project(np.array([[0.0, 0.0, -1.0]]))
    assert not CAMERA.contains(behind).any()
