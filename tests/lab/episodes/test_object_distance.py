"""The distance to an object, from its surface in the plane."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from box_scenes import room_boxes, scene_of
from hypernav.lab.episodes.object_distance import object_distance

LOW, HIGH = (1.0, 1.0), (1.5, 2.0)
SCENE = scene_of(*room_boxes(6.0, 4.0), ("bed", (*LOW, 0.0), (*HIGH, 0.5)))
BED = [instance for instance in SCENE.instances if instance.label is not None]


@given(st.floats(-3.0, 9.0), st.floats(-3.0, 9.0))
def test_it_is_the_distance_to_the_box_from_above(x, y):
    gaps = [max(low - at, at - high, 0.0) for at, low, high in zip((x, y), LOW, HIGH, strict=True)]
    assert object_distance(SCENE, BED, (x, y, 0.0)) == pytest.approx(math.hypot(*gaps), abs=1e-6)


@pytest.mark.parametrize(("z", "is_there"), [(0.0, True), (0.9, True), (1.1, False), (-2.6, False)])
def test_objects_of_other_storeys_do_not_count(z, is_there):
    assert (object_distance(SCENE, BED, (3.0, 1.5, z)) is not None) == is_there


def test_without_a_goal_there_is_no_distance():
    assert object_distance(SCENE, [], (3.0, 1.5, 0.0)) is None
