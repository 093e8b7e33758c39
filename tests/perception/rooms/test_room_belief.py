"""Where a goal is likely by what was seen, on maps drawn by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drawn_grids import drawn
from hypernav.core.goal import Goal
from hypernav.core.sightings import SeenThing
from hypernav.perception.rooms.room_belief import chances_of_goal

NO_WALLS = np.empty((0, 2))
HALL = drawn("\n".join(["." * 24] * 16), scale=10)  # 12 m by 8 m
KITCHEN = [SeenThing("oven", (1.0, 4.0)), SeenThing("refrigerator", (1.5, 4.0))]


def chances(goal, things, *positions, walls=NO_WALLS, grid=HALL):
    return chances_of_goal(Goal(goal), grid, things, walls, np.array(positions, dtype=np.float64))


def test_near_kitchen_things_a_microwave_is_likely_and_a_bed_is_not():
    assert chances("microwave", KITCHEN, (2.0, 4.0))[0] > 3.0
    assert chances("bed", KITCHEN, (2.0, 4.0))[0] < 0.5


def test_what_is_seen_tells_less_the_farther_it_is():
    near, far, farther = chances("microwave", KITCHEN, (2.0, 4.0), (6.0, 4.0), (11.9, 4.0))
    assert near > far >= farther
    assert farther == pytest.approx(1.0, abs=0.2)


def test_a_wall_cuts_off_what_is_known():
    wall = np.array([(3.0, y) for y in np.arange(0.05, 8.0, 0.1)])
    open_hall = chances("microwave", KITCHEN, (3.7, 4.0), (0.3, 0.3), (3.9, 7.9))
    walled = chances("microwave", KITCHEN, (3.7, 4.0), (0.3, 0.3), (3.9, 7.9), walls=wall)
    assert walled[0] < open_hall[0]
    assert walled[1] == pytest.approx(open_hall[1], rel=0.05)


def test_behind_the_kitchen_lies_rather_a_dining_room_than_a_server_room():
    wall = np.array([(3.0, y) for y in np.arange(0.05, 8.0, 0.1)])
    beyond = (4.5, 4.0)
    assert (
        chances("sideboard", KITCHEN, beyond, walls=wall[::60])[0]
        > chances("server rack", KITCHEN, beyond, walls=wall[::60])[0]
    )


@given(st.sampled_from(["bed", "oven", "gramophone", "chair"]))
def test_without_things_all_is_alike(goal):
    assert chances(goal, [], (1.0, 1.0), (9.0, 7.0)).tolist() == [1.0, 1.0]


def test_things_and_goals_that_no_table_knows_tell_nothing():
    unknown = [SeenThing("astrolabe", (1.0, 4.0))]
    assert chances("bed", unknown, (1.2, 4.0)).tolist() == [1.0]
    assert chances("astrolabe", KITCHEN, (1.2, 4.0)).tolist() == [1.0]


def test_the_order_of_things_does_not_matter_nor_a_second_one_beside_the_first():
    there = [(2.0, 4.0), (5.0, 2.0)]
    once = chances("microwave", KITCHEN, *there)
    assert chances("microwave", KITCHEN[::-1], *there) == pytest.approx(once)
    assert chances("microwave", [*KITCHEN, KITCHEN[0]], *there) == pytest.approx(once)
