"""Visibility of positions on the map in an image, and what stands in between."""

from dataclasses import replace

import numpy as np
import pytest

from hypernav.core.geometry.boxes import Box
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.memory.visibility import (
    is_cut_off,
    lies_open,
    seems_to_hold,
    should_be_visible,
)
from images import CAMERA, thing_before_wall

THING_M = 2.0
THING = np.array([[THING_M, y] for y in np.linspace(-0.3, 0.3, 13)])
"""What `thing_before_wall` shows in its middle."""
HEIGHT_M = 0.88
IMAGE = thing_before_wall(thing_m=THING_M)


def test_a_thing_in_sight_is_not_cut_off():
    assert not is_cut_off(THING, HEIGHT_M, IMAGE)
    assert should_be_visible(THING, HEIGHT_M, IMAGE)


@pytest.mark.parametrize("wall_m", [0.0, 0.6, 1.4])
def test_a_wall_in_between_cuts_it_off_even_if_it_is_too_near_to_be_measured(wall_m):
    walled = replace(IMAGE, depth=np.full_like(IMAGE.depth, wall_m))
    assert is_cut_off(THING, HEIGHT_M, walled)


def test_what_a_wall_hides_need_not_be_visible():
    walled = replace(IMAGE, depth=np.full_like(IMAGE.depth, 1.4))
    assert not should_be_visible(THING, HEIGHT_M, walled)


def test_what_something_lower_hides_need_not_be_visible_though_the_wall_behind_is():
    nightstand, height_m = THING + np.array([1.0, 0.0]), 0.3
    depth = np.full_like(IMAGE.depth, 4.0)
    assert should_be_visible(nightstand, height_m, replace(IMAGE, depth=depth))
    depth[CAMERA.height // 2 + 5 :] = 1.8  # a bed before it
    assert not should_be_visible(nightstand, height_m, replace(IMAGE, depth=depth))
    assert should_be_visible(nightstand, HEIGHT_M + 0.1, replace(IMAGE, depth=depth))


def test_an_objects_own_near_side_hides_nothing():
    depth = np.full_like(IMAGE.depth, 4.0)
    depth[CAMERA.height // 2 + 5 :] = 2.3  # the back of the sofa whose front was seen at 3 m
    sofa = replace(IMAGE, depth=depth)
    assert should_be_visible(THING + np.array([1.0, 0.0]), 0.3, sofa)


@pytest.mark.parametrize("distance_m", [0.5, 4.5])
def test_what_is_too_near_or_too_far_to_be_recognised_need_not_be_visible(distance_m):
    open_floor = thing_before_wall(thing_m=6.0, wall_m=6.0)
    positions = THING + np.array([distance_m - THING_M, 0.0])
    assert not should_be_visible(positions, HEIGHT_M, open_floor)


def test_what_lies_outside_the_image_is_not_said_to_be_hidden():
    turned = thing_before_wall(robot=Pose2(0.0, 0.0, 2.5), wall_m=0.6, thing_m=0.6)
    assert not is_cut_off(THING, HEIGHT_M, turned)
    assert not should_be_visible(THING, HEIGHT_M, turned)
    close_wall = thing_before_wall(wall_m=0.6, thing_m=0.6)
    assert not is_cut_off(THING, -3.0, close_wall)


@pytest.mark.parametrize("height_m", [-1.0, 3.0])
def test_what_hangs_above_the_image_or_lies_below_it_need_not_be_visible(height_m):
    assert not should_be_visible(THING, height_m, IMAGE)


def test_floor_before_a_wall_lies_open_and_floor_behind_it_does_not():
    before, behind, behind_me = np.array([[3.0, 0.0], [4.5, 0.0], [-1.0, 0.0]])
    assert lies_open(np.stack([before, behind, behind_me]), IMAGE).tolist() == [
        True,
        False,
        False,
    ]


def test_what_is_right_beside_the_camera_lies_open():
    assert lies_open(np.array([[-0.2, 0.1]]), IMAGE).all()


def test_a_column_without_any_return_shows_no_floor_and_refutes_no_object():
    too_near = replace(IMAGE, depth=np.zeros_like(IMAGE.depth))
    assert not lies_open(np.array([[1.0, 0.0], [30.0, 0.0]]), too_near).any()
    assert not should_be_visible(THING, HEIGHT_M, too_near)


def test_a_box_holds_a_thing_that_is_as_wide_and_as_far_away():
    left, right = (CAMERA.fx * side / THING_M + CAMERA.cx for side in (-0.3, 0.3))
    box = Box(left, 40.0, right, 80.0)
    assert seems_to_hold(box, THING, IMAGE)
    assert not seems_to_hold(box, THING + np.array([1.5, 0.0]), IMAGE)
    assert not seems_to_hold(box, THING - np.array([4.0, 0.0]), IMAGE)
    assert not seems_to_hold(Box(0.0, 40.0, float(CAMERA.width), 80.0), THING, IMAGE)
