import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.core.errors import CameraError
from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.transforms import Pose2, Transform, wrap_angle

coordinates = st.floats(-100, 100)
angles = st.floats(-50, 50)
poses = st.builds(Pose2, coordinates, coordinates, angles)


@given(angles)
def test_a_wrapped_angle_is_the_same_direction_in_the_half_open_range(angle):
    wrapped = wrap_angle(angle)
    assert -math.pi <= wrapped < math.pi
    assert math.cos(wrapped) == pytest.approx(math.cos(angle), abs=1e-9)
    assert math.sin(wrapped) == pytest.approx(math.sin(angle), abs=1e-9)


@given(poses, st.floats(-5, 5))
def test_a_transform_and_its_inverse_cancel(pose, z):
    there = pose.to_transform(z)
    back_and_forth = there.inverse() @ there
    np.testing.assert_allclose(back_and_forth.matrix, np.eye(4), atol=1e-9)


@given(poses, poses)
def test_chaining_is_the_same_as_applying_one_after_the_other(a, b):
    points = np.array([[1.0, 2.0, 3.0], [-4.0, 0.5, 0.0]])
    chained = (b.to_transform() @ a.to_transform()).apply(points)
    stepwise = b.to_transform().apply(a.to_transform().apply(points))
    np.testing.assert_allclose(chained, stepwise, atol=1e-8)


@given(poses)
def test_the_matrix_holds_all_of_a_transform(pose):
    there = pose.to_transform(0.3)
    np.testing.assert_array_equal(Transform.from_matrix(there.matrix).matrix, there.matrix)


@given(poses)
def test_yaw_survives_the_way_through_a_transform(pose):
    difference = wrap_angle(pose.to_transform().yaw - pose.yaw)
    assert abs(difference) < 1e-9


def test_bearing_is_positive_to_the_left():
    robot = Pose2(1.0, 1.0, math.pi / 2)  # looks along +y
    assert robot.bearing_to(0.0, 1.0) == pytest.approx(math.pi / 2)
    assert robot.bearing_to(2.0, 1.0) == pytest.approx(-math.pi / 2)
    assert robot.bearing_to(1.0, 5.0) == pytest.approx(0.0)


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
