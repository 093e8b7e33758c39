"""Two publishers of one odometry are told from a robot that drives."""

import math

import pytest

from hypernav.core.geometry.transforms import Pose2
from hypernav.robot.ros2.sensors import RivalOdometry


def words_of(*poses: Pose2) -> str | None:
    rivals = RivalOdometry()
    for pose in poses:
        rivals.note(pose)
    return rivals.words


@pytest.mark.parametrize("other", [Pose2(1.2, 0.0, 0.0), Pose2(0.0, 0.0, 0.5)])
def test_poses_that_jump_forth_and_back_have_two_publishers(other):
    words = words_of(*[Pose2(0.0, 0.0, 0.0), other] * 10)
    assert words is not None
    assert f"by {other.x:.2f} m" in words
    assert "two robots in one domain" in words


def test_a_driving_turning_swaying_and_once_relocalised_robot_has_one():
    driven = [Pose2(0.2 * i, 0.0, 0.1 * i) for i in range(40)]
    swaying = [Pose2(0.04 * math.sin(i), 0.0, 0.05 * math.cos(2 * i)) for i in range(40)]
    assert words_of(*driven, Pose2(0.0, 5.0, 1.0), *swaying) is None


def test_a_rival_that_has_ended_is_forgotten():
    jumping = [Pose2(0.0, 0.0, 0.0), Pose2(1.0, 0.0, 0.0)] * 20
    assert words_of(*jumping, *[Pose2(0.0, 0.0, 0.0)] * 40) is None
