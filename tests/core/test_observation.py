"""What an observation shows is the same in every frame that its poses are given in."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from box_views import room, view_of
from hypernav.core.geometry.transforms import Pose2

SEEN = view_of(room(4.0, 3.0), Pose2(1.0, 1.2, 0.3))
numbers = st.floats(-100.0, 100.0)


@given(numbers, numbers, st.floats(-4.0, 4.0), st.floats(-5.0, 5.0))
def test_points_robot_and_camera_move_with_the_frame(x, y, yaw, z):
    to_other = Pose2(x, y, yaw).to_transform(z)
    moved = SEEN.in_frame(to_other)
    rows, columns = np.array([100, 200]), np.array([40, 300])
    assert np.allclose(
        moved.points_at(rows, columns), to_other.apply(SEEN.points_at(rows, columns))
    )
    assert math.isclose(SEEN.robot.distance_to(0.0, 0.0), moved.robot.distance_to(x, y))
    ahead = np.array([[*SEEN.robot.ahead(1.0).xy, 0.0]])
    assert np.allclose(moved.robot.ahead(1.0).xy, to_other.apply(ahead)[0, :2])


@given(numbers, numbers, st.floats(-4.0, 4.0))
def test_there_and_back_is_the_same_again(x, y, yaw):
    to_other = Pose2(x, y, yaw).to_transform()
    again = SEEN.in_frame(to_other).in_frame(to_other.inverse())
    assert np.allclose(again.camera_to_map.matrix, SEEN.camera_to_map.matrix)
    assert np.allclose((*again.robot.xy, again.robot.yaw), (*SEEN.robot.xy, SEEN.robot.yaw))
