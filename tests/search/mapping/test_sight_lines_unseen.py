"""What a camera would look over of the unknown."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drawn_grids import drawn
from hypernav.search.mapping.sight_lines import unseen_by_bearing

# A free room, walls on the left and below, the unknown to the right and above.
ROOM = """
    ????????????
    ????????????
    #....???????
    #....???????
    #....???????
    #####???????
"""
MIDDLE = (1.5, 1.5)
BEARINGS = np.arange(72) * (2.0 * math.pi / 72)


def unseen(text=ROOM, position=MIDDLE, nearest_m=0.0, farthest_m=5.0):
    return unseen_by_bearing(
        drawn(text, scale=10), position, BEARINGS, nearest_m=nearest_m, farthest_m=farthest_m
    )


def test_behind_a_wall_nothing_is_in_sight():
    areas = unseen()
    west, south = areas[36], areas[54]
    assert west == south == 0.0
    assert areas[0] > 0.1  # east
    assert areas[18] > 0.1  # north


def test_where_all_is_known_nothing_is_unseen():
    assert unseen("....\n....\n....", (1.0, 0.75), farthest_m=0.7).sum() == 0.0


def test_beyond_the_range_and_before_the_nearest_floor_nothing_counts():
    assert unseen(farthest_m=0.9)[0] == 0.0
    assert 0.0 < unseen(nearest_m=3.0)[0] < unseen()[0]


def test_beyond_the_map_all_is_unknown():
    assert unseen("....", (1.0, 0.25))[0] > 0.1


@settings(max_examples=30, deadline=None)
@given(st.floats(0.6, 2.4), st.floats(0.6, 1.9), st.floats(0.5, 8.0))
def test_the_parts_are_never_more_than_the_circle(x, y, farthest_m):
    areas = unseen(position=(x, y), farthest_m=farthest_m)
    assert (areas >= 0.0).all()
    assert areas.sum() <= math.pi * farthest_m**2 * 1.02


def test_what_lies_deep_in_the_unknown_counts_less():
    near = unseen(farthest_m=3.0)[0] / (3.0**2 - 1.0)
    far = unseen(farthest_m=9.0)[0] / (9.0**2 - 1.0)
    assert far == pytest.approx(near, rel=1.0)
    assert far < near
