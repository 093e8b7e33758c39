from dataclasses import replace

import numpy as np
import pytest

from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.observation import Observation
from hypernav.core.sightings import SeenThing, Sightings


def view(depth_m: float) -> Observation:
    """A view through a camera whose frame is the map's, so that a thing's x is to its right."""
    return Observation(
        np.zeros((48, 64, 3), np.uint8),
        np.full((48, 64), depth_m, np.float32),
        PinholeCamera.from_hfov(64, 48, 90.0),
        Transform.identity(),
        Pose2(0.0, 0.0, 0.0),
    )


def found(label: str, box: Box, *, is_goal: bool = False) -> Detection:
    return Detection(box, 1.0, label, is_goal=is_goal)


MIDDLE, RIGHT = Box(24.0, 16.0, 40.0, 32.0), Box(56.0, 16.0, 64.0, 32.0)


def test_things_are_where_they_are_seen():
    seen = Sightings()
    seen.note(view(2.0), [found("sofa", MIDDLE), found("lamp", RIGHT)])
    sofa, lamp = seen.things
    assert (sofa.label, lamp.label) == ("sofa", "lamp")
    assert sofa.position == pytest.approx((0.0, 0.0), abs=0.1)
    assert lamp.position == pytest.approx((1.75, 0.0), abs=0.1)
    assert seen.image is not None


def test_a_thing_counts_once_and_the_goal_not_at_all():
    seen = Sightings()
    for depth_m in (2.0, 2.2):
        seen.note(view(depth_m), [found("lamp", RIGHT), found("bed", MIDDLE, is_goal=True)])
    assert [thing.label for thing in seen.things] == ["lamp"]
    seen.note(view(4.0), [found("lamp", RIGHT)])
    assert len(seen.things) == 2


def test_without_depth_there_is_no_position():
    seen = Sightings()
    seen.note(view(0.0), [found("lamp", RIGHT)])
    assert seen.things == ()


def test_a_new_search_has_seen_nothing():
    seen = Sightings()
    seen.note(view(2.0), [found("lamp", RIGHT)])
    seen.reset()
    assert (seen.things, seen.image) == ((), None)


def wall_at(depth_m: float) -> Observation:
    """A view straight ahead, from 0.88 m above the floor."""
    flat = view(depth_m)
    robot = Pose2(0.0, 0.0, 0.0)
    return replace(flat, camera_to_map=robot.to_transform() @ optical_to_base(0.88))


def test_walls_are_what_is_higher_than_furniture():
    seen = Sightings(tells_rooms=True)
    seen.note(wall_at(3.0), [])
    assert len(seen.walls)
    assert seen.walls[:, 0] == pytest.approx(np.full(len(seen.walls), 3.0), abs=0.1)
    assert Sightings(tells_rooms=True).walls.shape == (0, 2)


def test_walls_are_kept_only_for_who_asks_and_forgotten_with_all_else():
    seen = Sightings()
    seen.note(wall_at(3.0), [])
    assert not len(seen.walls)
    seen = Sightings(tells_rooms=True)
    seen.note(wall_at(3.0), [])
    seen.note_named({7: SeenThing("sofa", (1.0, 2.0))})
    assert 7 in seen.named
    seen.reset()
    assert not len(seen.walls)
    assert not seen.named
    assert not seen.things
