from dataclasses import replace

import numpy as np
import pytest

from hypernav.core.exploring.floors import SeenThing, Sightings
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.observation import Observation


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
    seen = Sightings().with_detections(view(2.0), [found("sofa", MIDDLE), found("lamp", RIGHT)])
    sofa, lamp = seen.things
    assert (sofa.label, lamp.label) == ("sofa", "lamp")
    assert sofa.position == pytest.approx((0.0, 0.0), abs=0.1)
    assert lamp.position == pytest.approx((1.75, 0.0), abs=0.1)


@pytest.mark.parametrize("quarters", range(4))
def test_a_thing_is_as_far_as_the_middle_of_its_box_whatever_is_beside_it(quarters):
    beside = np.full((64, 64), 4.0, np.float32)
    beside[24:40, 24:40] = 2.0  # the middle half of the box, in both directions
    beside[24:40, 35:40] = 4.0  # of which a third is a gap, on each side in turn
    seen = replace(
        view(2.0),
        rgb=np.zeros((64, 64, 3), np.uint8),
        depth=np.rot90(beside, quarters),
        camera=PinholeCamera.from_hfov(64, 64, 90.0),
        camera_to_map=Pose2(1.0, 2.0, 0.3).to_transform() @ optical_to_base(0.9),
    )
    box = Box(16.0, 16.0, 48.0, 48.0)
    (thing,) = Sightings().with_detections(seen, [found("lamp", box)]).things
    assert thing.position == pytest.approx(Pose2(1.0, 2.0, 0.3).ahead(2.0).xy, abs=0.05)


def test_a_thing_counts_once_and_the_goal_not_at_all():
    seen = Sightings()
    for depth_m in (2.0, 2.2):
        both = [found("lamp", RIGHT), found("bed", MIDDLE, is_goal=True)]
        seen = seen.with_detections(view(depth_m), both)
    assert [thing.label for thing in seen.things] == ["lamp"]
    seen = seen.with_detections(view(4.0), [found("lamp", RIGHT)])
    assert len(seen.things) == 2


def test_without_depth_there_is_no_position():
    seen = Sightings().with_detections(view(0.0), [found("lamp", RIGHT)])
    assert seen.things == ()


def test_what_was_seen_before_stays_as_it_was():
    before = Sightings()
    after = before.with_detections(view(2.0), [found("lamp", RIGHT)])
    assert before.things == ()
    assert len(after.things) == 1


def test_what_was_named_is_known_by_its_number():
    seen = Sightings().with_named({7: SeenThing("sofa", (1.0, 2.0))})
    assert 7 in seen.named
    assert [thing.label for thing in seen.things] == ["sofa"]


def test_a_named_thing_counts_once_and_its_number_all_the_same():
    seen = Sightings().with_named({7: SeenThing("sofa", (1.0, 2.0))})
    seen = seen.with_named({8: SeenThing("sofa", (1.2, 2.0))})
    assert len(seen.things) == 1
    assert seen.named == {7, 8}


def test_of_more_things_than_two_hundred_the_first_are_kept_and_all_numbers():
    lamps = {number: SeenThing("lamp", (1.5 * number, 0.0)) for number in range(300)}
    seen = Sightings().with_named(lamps)
    assert seen.things == tuple(lamps[number] for number in range(200))
    assert seen.named == lamps.keys()


@pytest.mark.parametrize(("away_m", "is_another"), [(0.99, False), (1.0, True)])
def test_things_of_one_name_a_metre_apart_are_two(away_m, is_another):
    first, second = (SeenThing("lamp", (x, 2.0)) for x in (3.0, 3.0 + away_m))
    seen = Sightings().with_named({1: first, 2: second})
    assert len(seen.things) == 1 + is_another
    other_name = SeenThing("sofa", first.position)
    assert len(seen.with_named({3: other_name}).things) == 2 + is_another
