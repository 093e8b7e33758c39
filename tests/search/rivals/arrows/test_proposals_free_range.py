"""Free ranges against walls whose distance is known."""

import math

import numpy as np
import pytest

from arrow_views import CAMERA, HERE, room_with_wall
from hypernav.core.embodiment import CameraConfig
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.rivals.arrows.proposals import RayMemory, all_headings, free_ranges

DOWN = CameraConfig(width=320, height=240, pitch_deg=20.0)


@pytest.mark.parametrize(("camera", "wall_m"), [(CAMERA, 3.0), (CAMERA, 2.2), (DOWN, 1.5)])
def test_the_floor_is_free_up_to_a_wall(camera, wall_m):
    headings = np.radians([-25.0, 0.0, 20.0])
    seen = room_with_wall(wall_m, camera=camera, pitch_deg=camera.pitch_deg)
    found = free_ranges(seen, headings, camera)
    # The lowest part of the wall, up to 0.16 m, counts as floor: the line may end a little behind.
    true = wall_m / np.cos(headings)
    assert (found > 0.93 * true).all()
    assert (found < true / (1.0 - 0.16 / 0.88) + 0.05).all()


def test_ranges_do_not_depend_on_where_the_robot_is():
    headings = all_headings(CAMERA)
    here = free_ranges(room_with_wall(), headings, CAMERA)
    there = room_with_wall(robot=Pose2(3.0, -2.0, 2.0))
    np.testing.assert_allclose(free_ranges(there, headings, CAMERA), here, atol=0.03)


def test_what_the_camera_does_not_see_is_not_free():
    headings = np.radians([-60.0, 60.0, 180.0])
    assert free_ranges(room_with_wall(), headings, CAMERA).tolist() == [0.0, 0.0, 0.0]


def test_a_wall_before_the_first_floor_in_view_blocks_the_way():
    assert free_ranges(room_with_wall(1.0), np.zeros(1), CAMERA)[0] == 0.0


def test_an_image_without_depth_shows_no_floor():
    seen = room_with_wall()
    seen.depth[:] = 0.0
    assert not free_ranges(seen, all_headings(CAMERA), CAMERA).any()


def test_where_the_robot_looked_is_explored_and_farther_it_is_not():
    memory = RayMemory()
    headings = np.array([-0.3, 0.0, 0.3])
    near, far = np.full(3, 1.5), np.full(3, 4.0)
    assert memory.look(HERE, headings, near).all()  # painted before it is asked
    assert not memory.look(HERE, headings, far).any()
    ahead = Pose2(1.7, 0.0, 0.0)
    assert not memory.look(ahead, np.zeros(1), np.array([4.0])).any()
    assert memory.look(HERE, np.zeros(1), np.array([3.2])).all()


@pytest.mark.parametrize(("beside_m", "explored"), [(0.2, True), (0.38, False)])
def test_floor_is_explored_if_the_strip_covers_it_and_not_if_it_comes_near(beside_m, explored):
    memory = RayMemory()
    memory.look(HERE, np.zeros(1), np.array([2.0]))  # 0.3 m to each side
    beside = Pose2(-2.2, beside_m, 0.0)  # asks about the floor 3.2 m ahead
    assert memory.look(beside, np.zeros(1), np.array([4.0])).tolist() == [explored]


def test_beyond_the_memory_nothing_is_explored():
    memory = RayMemory()
    memory.look(HERE, np.zeros(1), np.array([2.0]))
    far = Pose2(100.0, 100.0, 0.0)
    assert not memory.look(far, np.zeros(1), np.array([1.0])).any()
    assert math.isfinite(far.x)
