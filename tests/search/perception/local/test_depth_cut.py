from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from box_scenes import room_boxes, scene_of
from hypernav.core.embodiment import CameraConfig, Embodiment
from hypernav.core.geometry.boxes import Box
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.goal import Goal
from hypernav.search.memory.goal_area import points_under_mask
from hypernav.search.perception.local.depth_cut import DepthCutSegmenter, _divided
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from hypernav.simulator.worlds.simulation import SimulatedWorld
from images import thing_before_wall, thing_pixels
from small_episodes import episode_from


def overlap(a, b):
    return (a & b).sum() / (a | b).sum()


@pytest.mark.parametrize("box", [(55, 35, 105, 85), (60, 40, 100, 80), (58, 42, 98, 84)])
def test_a_loose_box_is_cut_to_the_thing(box):
    observation = thing_before_wall()
    mask = DepthCutSegmenter().segment(observation, Box(*map(float, box)))
    assert overlap(mask, thing_pixels(observation)) > 0.85


def test_the_nearer_of_two_surfaces_is_the_thing():
    observation = thing_before_wall(thing_m=1.5, wall_m=2.2, box=(50, 30, 110, 90))
    mask = DepthCutSegmenter().segment(observation, Box(40.0, 20.0, 120.0, 100.0))
    assert observation.depth[mask].max() == pytest.approx(1.5)


def test_the_same_image_gives_the_same_cut():
    observation = thing_before_wall()
    box = Box(55.0, 35.0, 105.0, 85.0)
    first, second = (DepthCutSegmenter().segment(observation, box) for _ in range(2))
    np.testing.assert_array_equal(first, second)


def test_a_box_without_depth_is_taken_whole():
    observation = thing_before_wall(thing_m=0.0, wall_m=0.0)
    mask = DepthCutSegmenter().segment(observation, Box(60.0, 40.0, 100.0, 80.0))
    assert overlap(mask, thing_pixels(observation)) > 0.9


def test_what_stands_before_a_thing_beyond_the_range_is_not_the_thing():
    """A post of 10 by 40 pixels stands before something that is too far away for depth."""
    observation = thing_before_wall(thing_m=1.5, wall_m=0.0, box=(60, 40, 70, 80))
    mask = DepthCutSegmenter().segment(observation, Box(55.0, 35.0, 105.0, 85.0))
    assert mask.any()
    assert (observation.depth[mask] == 0.0).all()


@pytest.mark.parametrize("box", [(-50, -50, -10, -10), (200, 10, 300, 50), (10, 10, 10, 40)])
def test_a_box_outside_the_image_holds_nothing(box):
    mask = DepthCutSegmenter().segment(thing_before_wall(), Box(*map(float, box)))
    assert not mask.any()


@pytest.mark.parametrize("box", [(0, 0, 160, 120), (159, 119, 160, 120), (-20, -20, 400, 400)])
def test_extreme_boxes_do_not_break_it(box):
    mask = DepthCutSegmenter().segment(thing_before_wall(), Box(*map(float, box)))
    assert mask.shape == (120, 160)


@pytest.mark.parametrize("row", [1.0, 2.0, 50.0, 117.0])
def test_a_box_one_pixel_high_does_not_break_it(row):
    seen = thing_before_wall()
    mask = DepthCutSegmenter().segment(seen, Box(2.0, row, 158.0, row + 1.0))
    assert mask.shape == seen.depth.shape


def test_a_wall_that_goes_on_beside_the_box_is_not_the_thing():
    """Most of the box is the wall behind two posts and a bar; these reach from side to side."""
    observation = thing_before_wall(thing_m=2.0, wall_m=2.6, box=(55, 35, 105, 85))
    observation.depth[43:85, 61:99] = 2.6
    observation.rgb[43:85, 61:99] = 150
    frame = observation.depth == 2.0
    mask = DepthCutSegmenter().segment(observation, Box(54.0, 34.0, 106.0, 86.0))
    assert overlap(mask, frame) > 0.7
    assert not mask[50:80, 65:95].any()


@pytest.mark.parametrize(("side_px", "is_thing"), [(14, False), (16, True)])
def test_a_box_over_a_wall_is_of_what_stands_before_it_unless_that_is_small(side_px, is_thing):
    """What ends in the box may be a quarter as wide and high as the box, hardly less."""
    low, high = (80 - side_px // 2, 45 - side_px // 2), (80 + side_px // 2, 45 + side_px // 2)
    observation = thing_before_wall(thing_m=2.0, wall_m=2.4, box=(*low, *high))
    mask = DepthCutSegmenter().segment(observation, Box(50.0, 15.0, 110.0, 75.0))
    assert np.array_equal(mask, thing_pixels(observation)) is is_thing
    assert mask[20:30, 55:65].all() == (not is_thing)


def test_what_stands_before_a_thing_and_goes_on_below_the_box_is_not_the_thing():
    observation = thing_before_wall(thing_m=2.5, box=(50, 40, 110, 80))
    observation.depth[60:120, 70:80] = 1.5
    observation.rgb[60:120, 70:80] = (90, 60, 30)
    mask = DepthCutSegmenter().segment(observation, Box(50.0, 40.0, 110.0, 80.0))
    assert not mask[62:78, 72:78].any()
    assert mask[45:75, 55:65].mean() > 0.9


def seen_in_a_room(name, low, high):
    """What a robot sees that stands in a room, 2 m before a thing."""
    config = Embodiment(camera=CameraConfig(width=160, height=120))
    world = SimulatedWorld(scene_of(*room_boxes(6.0, 4.0), (name, low, high)), embodiment=config)
    observation = world.reset(episode_from(Pose2(1.5, 1.2, 0.0)))
    (detection,) = GroundTruthDetector().detect(observation, Goal(name))
    return observation, detection


def test_the_floor_before_a_thing_is_no_part_of_it():
    observation, bed = seen_in_a_room("bed", (3.5, 0.4, 0.0), (5.5, 1.8, 0.5))
    mask = DepthCutSegmenter().segment(observation, bed.box)
    points = points_under_mask(mask, observation, min_depth_m=0.5, max_depth_m=5.0)
    assert points[:, 2].min() > 0.04
    assert overlap(mask, bed.mask) > 0.8


def test_what_lies_on_the_floor_is_kept():
    observation, rug = seen_in_a_room("rug", (3.0, 0.6, 0.0), (4.6, 1.8, 0.02))
    mask = DepthCutSegmenter().segment(observation, rug.box)
    assert overlap(mask, rug.mask) > 0.6


@pytest.mark.parametrize("point", [(80.0, 60.0), (61.0, 41.0), (99.5, 79.5)])
def test_a_point_takes_the_thing_that_it_is_on(point):
    observation = thing_before_wall()
    mask = DepthCutSegmenter().segment_point(observation, *point)
    assert not (mask & ~thing_pixels(observation)).any()
    assert overlap(mask, thing_pixels(observation)) > 0.95


def test_a_point_takes_no_floor_and_a_point_on_a_rug_takes_it():
    observation, bed = seen_in_a_room("bed", (3.5, 0.4, 0.0), (5.5, 1.8, 0.5))
    x, y = (bed.box.x_min + bed.box.x_max) / 2.0, (bed.box.y_min + bed.box.y_max) / 2.0
    mask = DepthCutSegmenter().segment_point(observation, x, y)
    points = points_under_mask(mask, observation, min_depth_m=0.5, max_depth_m=5.0)
    assert points[:, 2].min() > 0.04
    assert (mask & bed.mask).sum() > 0.5 * mask.sum()
    on_floor = DepthCutSegmenter().segment_point(observation, 80.0, 118.0)
    assert (on_floor & bed.mask).sum() < 0.1 * on_floor.sum()


@pytest.mark.parametrize("quarters", [1, 2, 3])
def test_a_camera_on_its_side_sees_the_same_of_a_thing_and_of_the_floor(quarters):
    upright, bed = seen_in_a_room("bed", (3.5, 0.4, 0.0), (5.5, 1.8, 0.5))
    width, height = upright.camera.width, upright.camera.height
    seen, point, camera = (
        upright,
        np.array([bed.box.x_min + 5.5, bed.box.y_max - 5.5]),
        upright.camera,
    )
    for _ in range(quarters):  # what was the right edge of the image becomes its upper one
        camera = PinholeCamera(
            camera.height, camera.width, camera.fy, camera.fx, camera.cy, camera.width - camera.cx
        )
        turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
        seen = replace(
            seen,
            rgb=np.rot90(seen.rgb),
            depth=np.rot90(seen.depth),
            camera=camera,
            camera_to_map=seen.camera_to_map @ Transform(turn, np.zeros(3)),
            truth=None,
        )
        point = np.array([point[1], camera.height - point[0]])
    cut = DepthCutSegmenter().segment_point(seen, *point)
    expected = DepthCutSegmenter().segment_point(upright, bed.box.x_min + 5.5, bed.box.y_max - 5.5)
    assert 100 < expected.sum() < 0.5 * width * height
    np.testing.assert_array_equal(np.rot90(cut, -quarters), expected)


def test_a_point_without_depth_around_it_holds_nothing():
    observation = thing_before_wall(thing_m=0.0)
    assert not DepthCutSegmenter().segment_point(observation, 80.0, 60.0).any()
    assert DepthCutSegmenter().segment_point(observation, 61.0, 60.0).any()  # the wall, 2 px away


@given(st.integers(0, 2**32 - 1), st.sampled_from([(9, 12), (12, 7), (2, 2)]))
def test_parts_are_pixels_that_are_linked_by_steps_in_depth_below_the_gap(seed, shape):
    rng = np.random.default_rng(seed)
    depth = rng.choice([1.0, 1.3, 1.6, 2.5], shape, p=(0.4, 0.3, 0.2, 0.1)).astype(np.float32)
    solid = rng.uniform(size=shape) < 0.9
    part = np.full(shape, -1)
    for number, begin in enumerate(zip(*np.nonzero(solid), strict=True)):
        waiting = [begin] if part[begin] < 0 else []
        while waiting:
            at = waiting.pop()
            part[at] = number
            for i, j in ((0, 1), (1, 0), (0, -1), (-1, 0)):
                to = (at[0] + i, at[1] + j)
                if all(0 <= k < most for k, most in zip(to, shape, strict=True)):
                    is_linked = abs(depth[to] - depth[at]) < 0.35
                    if solid[to] and part[to] < 0 and is_linked:
                        waiting.append(to)
    found = _divided(depth, solid, 0.35)
    assert np.array_equal(found > 0, solid)
    pairs = set(zip(found[solid].tolist(), part[solid].tolist(), strict=True))
    assert len(pairs) == len(set(part[solid].tolist())) == len(set(found[solid].tolist()))
