"""One map frame for several episodes, as a localised robot has it."""

import numpy as np
import pytest

from hypernav.core.embodiment import Action
from hypernav.core.geometry.transforms import Pose2
from small_episodes import episode_from
from small_worlds import two_rooms

FIRST, SECOND = Pose2(2.5, 1.0, 1.5), Pose2(6.0, 3.0, 3.1)


def test_without_a_kept_frame_it_begins_at_every_start():
    for start in (FIRST, SECOND):
        assert two_rooms().reset(episode_from(start)).robot == Pose2(0.0, 0.0, 0.0)


def test_in_a_kept_frame_poses_and_points_are_where_they_are_in_the_scene():
    world = two_rooms()
    world.reset(episode_from(FIRST))
    frame = world.map_to_scene
    world.keep_map_frame(frame)
    world.reset(episode_from(SECOND))
    observation = world.step(Action.MOVE_FORWARD)
    world.keep_map_frame(None)
    in_scene = frame @ observation.robot.to_transform()
    assert in_scene.translation[:2] == pytest.approx(np.array(world.pose.xy))
    assert in_scene.yaw == pytest.approx(world.pose.yaw)
    camera = frame @ observation.camera_to_map
    assert camera.matrix == pytest.approx(world.camera_to_scene.matrix)
