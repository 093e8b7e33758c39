import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

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
