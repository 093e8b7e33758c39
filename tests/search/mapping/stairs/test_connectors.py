"""What the robot knows of stairs: seen how often, tried or not, and where they lead."""

import math
from dataclasses import replace

import numpy as np
import pytest

from box_views import FLOOR, view_of
from hypernav.core.embodiment import Embodiment
from hypernav.core.exploring.floors import Drop
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.mapping.stairs.connectors import (
    MOST_CONNECTORS,
    Connector,
    Passage,
    relied_on,
    with_sightings,
)
from hypernav.search.memory.floor_exits import (
    drops_to_look_at,
    known_floors,
    stairs_to_new_floors,
    stairs_to_unseen,
    ways_out,
)
from stair_views import (
    CAMERA,
    FIRST_X,
    MIDDLE_Y,
    before_stairs,
    edge,
    memory_after,
    stairs_down,
    stairs_up,
)


def test_one_image_is_not_enough_to_rely_on_stairs():
    memory = memory_after([FLOOR, *stairs_up()], *before_stairs(2.5))
    assert memory.connectors
    assert not ways_out(memory)


def test_a_robot_that_cannot_climb_looks_for_no_stairs():
    memory = memory_after([FLOOR, *stairs_up()], *before_stairs(2.5, 2.0), robot=Embodiment())
    assert memory.elevation is None
    assert not memory.connectors
    assert not memory.on_stairs


def test_stairs_without_a_path_are_a_way_again_once_exploration_begins_anew():
    memory = memory_after([FLOOR, *stairs_up()], *before_stairs(3.0, 2.5, 2.0))
    (way,) = ways_out(memory)
    memory.search.unreached.add(way.connector)
    assert not ways_out(memory)
    memory.search.forget_exploration()
    assert ways_out(memory) == [way]


def test_stairs_that_were_refuted_are_no_way_out_however_often_they_are_seen():
    memory = memory_after([FLOOR, *stairs_up()], *before_stairs(3.0, 2.5))
    assert len(ways_out(memory)) == 1
    memory.give_up(0)
    for pose in before_stairs(2.5, 2.4):
        memory.follow(view_of([FLOOR, *stairs_up()], pose, camera=CAMERA))
    assert not ways_out(memory)


def test_where_the_floor_ends_is_looked_at_from_near_unless_stairs_are_known_there():
    well = [*stairs_down(), ((5.2, -10.0, -3.0), (12.0, 10.0, 2.5))]
    memory = memory_after([FLOOR])
    floor = memory.floor

    def look_from(*distances_m: float, yaw: float = 0.0):
        for pose in before_stairs(*distances_m, yaw=yaw):
            floor.integrate(view_of(well, pose, camera=CAMERA))

    look_from(3.0, 2.5, 2.0)
    (edge,) = drops_to_look_at(memory)
    assert edge.xy == pytest.approx((FIRST_X, MIDDLE_Y), abs=0.7)
    assert edge.axis is None
    for is_up in (True, False):
        memory.connectors = (Connector(0, is_up, (FIRST_X, MIDDLE_Y), 0.0, sightings=2),)
        assert not drops_to_look_at(memory)
    memory.connectors = (Connector(1, False, (FIRST_X, MIDDLE_Y), 0.0, sightings=2),)
    assert drops_to_look_at(memory) == [edge]
    memory.connectors = (Connector(0, False, (FIRST_X, MIDDLE_Y), 0.1, sightings=1),)
    doubtful = memory.connectors
    assert drops_to_look_at(memory) == [Drop(FIRST_X, MIDDLE_Y, axis=0.1)]
    look_from(1.0, 0.5, 0.2, yaw=math.pi)
    for known in ((), doubtful):
        memory.connectors = known
        assert drops_to_look_at(memory)
    look_from(1.0, 0.5, 0.2)
    for known in ((), doubtful):
        memory.connectors = known
        assert not drops_to_look_at(memory)


@pytest.mark.parametrize("y", [MIDDLE_Y - 1.0, MIDDLE_Y, MIDDLE_Y + 1.0])
def test_an_edge_is_looked_at_where_it_is_nearest_to_where_the_robot_has_been(y: float):
    cliff = [
        ((-10.0, -10.0, -3.0), (FIRST_X, 10.0, 0.0)),
        ((FIRST_X, -10.0, -3.0), (12.0, 10.0, -1.8)),
        ((5.2, -10.0, -3.0), (12.0, 10.0, 2.5)),
    ]
    memory = memory_after([FLOOR])
    for x in (1.0, 1.5, 2.0):
        memory.floor.integrate(view_of(cliff, Pose2(x, y, 0.0), camera=CAMERA))
    (found,) = drops_to_look_at(memory)
    assert found.xy == pytest.approx((FIRST_X, y), abs=0.35)


@pytest.mark.parametrize(("passage", "same_m"), [(Passage.UNTRIED, 1.0), (Passage.REFUTED, 0.5)])
def test_sightings_are_of_one_connector_up_to_a_distance_in_any_direction(passage, same_m: float):
    known = replace(edge(0.3), passage=passage)
    for bearing in (0.0, 0.5, 1.0, 1.5):
        x, y = (round(one(bearing * math.pi)) for one in (math.cos, math.sin))
        assert known.is_same(replace(edge(2.0), end=(same_m * x, same_m * y)))
        assert not known.is_same(replace(edge(0.3), end=(1.01 * same_m * x, 1.01 * same_m * y)))
    assert not known.is_same(replace(known, goes_up=True))
    assert not known.is_same(replace(known, floor=1))


def test_behind_a_railing_the_floor_ends_for_nobody():
    well = [*stairs_down(), ((5.2, -10.0, -3.0), (12.0, 10.0, 2.5))]
    bars = [
        ((FIRST_X - 0.1, y, 0.0), (FIRST_X - 0.05, y + 0.03, 0.9))
        for y in np.arange(MIDDLE_Y - 1.5, MIDDLE_Y + 1.5, 0.12)
    ]
    for boxes, expected in ((well, 1), ([*well, *bars], 0)):
        memory = memory_after([FLOOR])
        for pose in before_stairs(3.0, 2.5, 2.0):
            memory.floor.integrate(view_of(boxes, pose, camera=CAMERA))
        assert len(memory.floor.map.edges_to_drops()) > 0
        assert len(drops_to_look_at(memory)) == expected


@pytest.mark.parametrize(
    ("storey_m", "is_known"), [(-0.9, False), (-1.8, True), (-3.0, True), (-5.6, False)]
)
def test_where_the_robot_knows_the_next_floor_down_no_edge_is_looked_at(
    storey_m: float, is_known: bool
):
    """Of a floor two storeys down it knows only that there is one between."""
    well = [*stairs_down(), ((5.2, -10.0, -3.0), (12.0, 10.0, 2.5))]
    memory = memory_after([FLOOR])
    for pose in before_stairs(3.0, 2.5, 2.0):
        memory.floor.integrate(view_of(well, pose, camera=CAMERA))
    memory.add_floor(storey_m)
    assert drops_to_look_at(memory)
    far = (FIRST_X, MIDDLE_Y - 3.0)
    taken = Connector(0, False, far, 0.0, Passage.USED, other_floor=1, sightings=2)
    memory.connectors = (taken,)
    assert bool(drops_to_look_at(memory)) is not is_known


@pytest.mark.parametrize("goes_up", [True, False])
def test_new_stairs_towards_the_floor_that_the_robot_came_from_lead_to_no_new_one(goes_up: bool):
    memory = memory_after([FLOOR])
    down, up = (Connector(0, one, (5.0, 0.0), 0.0, sightings=2) for one in (False, True))
    memory.connectors = (down, up)
    assert [one.connector for one in stairs_to_new_floors(memory)] == [0, 1]
    memory.add_floor(2.6 if goes_up else -2.6)
    used = replace(up if goes_up else down, end=(9.0, 0.0), passage=Passage.USED, other_floor=1)
    memory.connectors = (down, up, used)
    assert [one.connector for one in stairs_to_new_floors(memory)] == [0 if goes_up else 1]
    assert [one.connector for one in stairs_to_unseen(memory)] == [0 if goes_up else 1, 2]
    memory.number = 1
    memory.connectors = (*memory.connectors, replace(used, floor=1, other_floor=0))
    (left,) = known_floors(memory)
    assert [one.connector for one in left.stairs] == [0 if goes_up else 1, 2]
    memory.number = 0
    memory.give_up(2)
    assert [one.connector for one in stairs_to_new_floors(memory)] == [0, 1]


def test_used_stairs_are_known_from_both_ends_and_lead_on_until_all_is_explored():
    memory = memory_after([FLOOR, *stairs_up()], *before_stairs(3.0, 2.5))
    memory.number = memory.add_floor(1.8)
    memory.crossed(0)
    there, back = memory.connectors
    assert (there.floor, there.other_floor, there.goes_up) == (0, 1, True)
    assert (back.floor, back.other_floor, back.goes_up) == (1, 0, False)
    assert [one.connector for one in ways_out(memory)] == [1]
    assert not stairs_to_new_floors(memory)
    memory.floors[0].was_explored = memory.floors[0].search.is_explored = True
    assert not ways_out(memory)


def test_a_floor_that_an_earlier_search_explored_is_not_unseen_and_yet_left_to_this_one():
    memory = memory_after([FLOOR, *stairs_up()], *before_stairs(3.0, 2.5))
    memory.number = memory.add_floor(1.8)
    memory.crossed(0)
    memory.floors[0].was_explored = True
    memory.begin_search(sees_stairs=True)
    assert not stairs_to_unseen(memory)
    assert [one.connector for one in ways_out(memory)] == [1]


def test_the_way_to_what_is_unseen_is_the_one_over_the_fewest_stairs():
    """Else a robot between two such ways might go to and fro."""
    memory = memory_after([FLOOR], Pose2(0.0, 0.0, 0.0))
    memory.add_floor(1.8)
    up = Connector(0, True, (1.0, 0.0), 0.0, Passage.USED, other_floor=1, sightings=2)
    back = replace(up, floor=1, goes_up=False, other_floor=0)
    new = Connector(0, False, (5.0, 0.0), 0.0, sightings=2)
    memory.connectors = (up, back, replace(new, floor=1, goes_up=True))
    memory.floors[0].was_explored = memory.floors[1].was_explored = True
    assert [one.connector for one in stairs_to_unseen(memory)] == [0]
    memory.connectors = (*memory.connectors, new)
    assert [one.connector for one in stairs_to_unseen(memory)] == [3]
    memory.give_up(3)
    memory.floors[1].search.given_up.add(2)
    assert not stairs_to_unseen(memory)


def test_stairs_that_were_taken_stay_a_way_though_a_search_fails_on_them():
    memory = memory_after([FLOOR, *stairs_up()], *before_stairs(3.0, 2.5))
    memory.number = memory.add_floor(1.8)
    memory.crossed(0)
    memory.give_up(1)
    assert not ways_out(memory)
    memory.begin_search(sees_stairs=True)
    assert [one.connector for one in ways_out(memory)] == [1]
    assert {one.passage for one in memory.connectors} == {Passage.USED}


def test_stairs_to_another_level_of_the_floor_are_stairs_and_no_way_out():
    memory = memory_after([FLOOR, *stairs_up()], *before_stairs(3.0, 2.5))
    memory.reached_level(0)
    assert memory.connectors[0].passage is Passage.USED
    assert not ways_out(memory)


def test_the_axis_is_the_mean_of_sightings_that_agree():
    (known,) = with_sightings([edge(0.0)], [edge(0.2)])
    assert known.axis == pytest.approx(0.1)
    (known,) = with_sightings([known], [edge(0.1 + math.tau)])
    assert known.axis == pytest.approx(0.1)
    (known,) = with_sightings([known], [edge(1.5)])
    assert known.axis == 1.5


def test_half_of_all_connectors_that_fit_into_a_memory_are_left_for_what_the_robot_takes():
    many = [edge(0.0, x=10.0 * k) for k in range(MOST_CONNECTORS)]
    known = with_sightings((), many)
    assert known == tuple(many[: MOST_CONNECTORS // 2])
    again = with_sightings(known, many[-3:] + many[:3])
    assert [one.sightings for one in again] == [2] * 3 + [1] * (len(known) - 3)


def test_stairs_that_the_robot_is_on_count_however_seldom_they_were_seen():
    here = Connector(0, False, (3.0, 1.0), 0.0)
    once = replace(here, end=(3.4, 1.0), axis=0.2, sightings=1)
    known, number = relied_on([once], here)
    assert (number, [one.end for one in known]) == (0, [once.end])
    assert known[0].is_new
    known, number = relied_on([], here)
    assert number == 0
    assert known[0].is_new


@pytest.mark.parametrize("passage", [Passage.USED, Passage.REFUTED])
def test_stairs_that_were_tried_are_not_relied_on_anew(passage):
    floor = 1 if passage is Passage.USED else None
    tried = Connector(0, False, (3.0, 1.0), 0.0, passage=passage, other_floor=floor)
    assert relied_on([tried], replace(tried, passage=Passage.UNTRIED)) == ((tried,), None)
