"""Frames are connected as tf says, at the times that it says."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from hypernav.core.errors import TransformMissingError
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.robot.ros.transform_tree import TransformTree

MOUNT = Transform(Rotation.from_euler("xyz", [0.1, 0.2, 0.3]).as_matrix(), np.array([0.1, 0, 1]))
numbers = st.floats(-5.0, 5.0)
poses = st.builds(lambda x, y, yaw: Pose2(x, y, yaw).to_transform(), numbers, numbers, numbers)


def tree_of(*odometry: tuple[float, Transform]) -> TransformTree:
    tree = TransformTree()
    tree.add("base_link", "camera", MOUNT, 0.0, static=True)
    for at_s, pose in odometry:
        tree.add("odom", "base_link", pose, at_s, static=False)
    return tree


@given(poses, poses, st.floats(0.0, 1.0))
def test_a_pose_and_the_pose_the_other_way_round_cancel(first, last, at_s):
    tree = tree_of((0.0, first), (1.0, last))
    there = tree.pose("camera", "odom", at_s)
    back = tree.pose("odom", "camera", at_s)
    assert np.allclose((there @ back).matrix, np.eye(4), atol=1e-9)


@given(poses, poses)
def test_a_known_pose_is_exact_whatever_comes_after(first, last):
    tree = tree_of((1.0, last), (0.0, first))
    assert np.allclose(tree.pose("camera", "odom", 0.0).matrix, (first @ MOUNT).matrix)


def test_between_two_poses_it_moves_evenly():
    tree = tree_of((0.0, Pose2(0, 0, 0).to_transform()), (0.5, Pose2(2, 0, 1).to_transform()))
    middle = tree.pose("base_link", "odom", 0.125)
    assert middle.translation == pytest.approx([0.5, 0.0, 0.0])
    assert middle.yaw == pytest.approx(0.25)


def test_a_pose_holds_a_moment_longer_and_no_more():
    tree = tree_of((0.0, Transform.identity()), (3.0, Transform.identity()))
    tree.pose("camera", "odom", 3.1)
    for at_s in (1.5, 3.5, -1.0):
        with pytest.raises(TransformMissingError, match="clocks"):
            tree.pose("camera", "odom", at_s)


def test_frames_of_other_trees_have_no_pose():
    tree = tree_of((0.0, Transform.identity()))
    assert tree.root_of("camera") == "odom"
    with pytest.raises(TransformMissingError, match="'map'"):
        tree.pose("camera", "map", 0.0)


def test_a_frame_with_the_prefix_of_a_robot_is_named():
    tree = TransformTree()
    tree.add("robot1/odom", "robot1/base_link", Transform.identity(), 0.0, static=False)
    words = "there is 'robot1/base_link' instead of 'base_link', 'robot1/odom' instead of 'odom'"
    with pytest.raises(TransformMissingError, match=words):
        tree.pose("base_link", "odom", 0.0)


def test_a_loop_of_frames_ends():
    tree = tree_of((0.0, Transform.identity()))
    tree.add("camera", "odom", Transform.identity(), 0.0, static=True)
    assert tree.root_of("camera") == "odom"


def test_old_poses_are_forgotten():
    tree = TransformTree(memory_s=1.0)
    for at_s in range(5):
        tree.add("odom", "base_link", Pose2(at_s, 0, 0).to_transform(), at_s, static=False)
    assert tree.pose("base_link", "odom", 3.0).translation[0] == 3.0
    with pytest.raises(TransformMissingError):
        tree.pose("base_link", "odom", 1.0)


def test_a_frame_with_two_parents_has_no_pose():
    tree = tree_of((0.0, MOUNT))
    tree.add("base_footprint", "base_link", MOUNT, 0.0, static=True)
    with pytest.raises(TransformMissingError, match=r"'base_link'.*'odom'.*'base_footprint'"):
        tree.pose("camera", "odom", 0.0)
    assert tree.pose("camera", "base_link", 0.0).translation == pytest.approx(MOUNT.translation)
