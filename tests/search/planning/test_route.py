"""A route: what is left of a path, and which waypoints count as passed."""

import math
from itertools import pairwise

import pytest

from hypernav.core.embodiment import Action
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.planning.follower import DeadEnd, Route, along_line
from hypernav.search.planning.planner import PlannedPath

PATH = PlannedPath(((0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (10.0, 3.0)), 0.0, 0.0, True)
LEFT = (Action.TURN_LEFT,)


def test_a_path_is_as_long_as_its_legs_and_ends_at_its_last_waypoint():
    assert PATH.length_m == 13.0
    assert PATH.end == (10.0, 3.0)


def test_a_new_path_starts_anew_and_keeps_its_actions_if_its_end_is_the_same():
    old = Route(PATH, next_waypoint=3, actions=LEFT, arrived=True, age=4)
    same = old.along(PlannedPath(((1.0, 0.0), (10.0, 3.1)), 0.0, 0.0, True), 0.3, 0.25)
    assert (same.next_waypoint, same.actions, same.arrived) == (1, LEFT, False)
    assert (same.clearance_m, same.tolerance_m) == (0.3, 0.25)
    other = old.along(PlannedPath(((1.0, 0.0), (10.0, 4.0)), 0.0, 0.0, True), 0.3, 0.25)
    assert other.actions == ()
    assert (
        old.along(None, 0.3, 0.25).actions
        == Route(actions=LEFT).along(PATH, 0.3, 9.0).actions
        == ()
    )


@pytest.mark.parametrize(
    ("robot", "next_waypoint"),
    [
        (Pose2(3.0, 0.0, 0.0), 1),
        (Pose2(3.9, 0.1, 0.0), 2),  # near the first corner
        (Pose2(4.1, 1.5, 0.0), 2),  # behind it, beside the next leg
        (Pose2(4.5, 1.5, 0.0), 1),  # too far beside it
        (Pose2(4.0, 2.9, 0.0), 3),  # near the second corner, past the first
        (Pose2(8.0, 3.1, 0.0), 1),  # past the second, but not past the first
    ],
)
def test_waypoints_are_passed_one_after_the_other(robot: Pose2, next_waypoint: int):
    route = Route(PATH, tolerance_m=0.25)
    assert route.seen_from(robot).next_waypoint == next_waypoint
    assert route.points_left(robot) == (robot.xy, *PATH.waypoints[next_waypoint:])
    corners = [robot.xy, *PATH.waypoints[next_waypoint:]]
    left_m = sum(math.dist(a, b) for a, b in pairwise(corners))
    assert route.left_m(robot) == pytest.approx(left_m)


def test_a_waypoint_that_was_passed_stays_passed():
    route = Route(PATH, next_waypoint=2, tolerance_m=0.25)
    assert route.seen_from(Pose2(1.0, 0.0, 0.0)).next_waypoint == 2


def test_without_a_path_nothing_is_left():
    robot = Pose2(1.0, 2.0, 0.0)
    assert (Route().points_left(robot), Route().left_m(robot)) == ((), 0.0)
    assert Route().remaining(robot) == []


def test_a_point_lies_along_a_line_and_to_the_left_of_it():
    ahead, beside = along_line((1.0, 1.0), (1.0, 5.0), Pose2(-1.0, 4.0, 0.0))
    assert (ahead, beside) == pytest.approx((3.0, 2.0))
    assert along_line((1.0, 1.0), (1.0, 1.0), Pose2(2.0, 2.0, 0.0)) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("position", "clearance_m", "end", "nowhere"),
    [
        ((4.2, 1.0), 0.3, (10.0, 3.0), True),
        ((7.0, 3.2), 0.3, (10.0, 2.8), True),
        ((7.0, 3.3), 0.3, (10.0, 3.0), False),
        ((10.2, 3.0), 0.3, (10.0, 3.0), True),
        ((10.4, 3.0), 0.3, (10.0, 3.0), False),
        ((4.2, 1.0), 0.2, (10.0, 3.0), False),
        ((4.2, 1.0), 0.3, (10.0, 3.5), False),
    ],
)
def test_a_path_leads_nowhere_through_a_dead_end_to_the_same_end(
    position, clearance_m, end, nowhere
):
    route = Route(dead_ends=frozenset({DeadEnd(position, clearance_m, end)}))
    assert route.leads_nowhere(PATH, 0.3) == nowhere
