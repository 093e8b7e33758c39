"""Noticing that the robot ran into something."""

import numpy as np

from drawn_grids import drawn
from hypernav.core.embodiment import Action, Embodiment
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.planning.bump_sensor import bumped_points
from hypernav.search.planning.config import PlanningConfig

CONFIG = PlanningConfig()
HALL = drawn("....................\n" * 20, scale=10, origin=(-5.0, -5.0))


def bumped(ordered, robot, grid=HALL, *, way=(), config=CONFIG):
    return bumped_points(ordered, robot, way, grid, config, Embodiment())


def with_obstacle(rows: slice, columns: slice) -> OccupancyGrid:
    """The hall with something in it."""
    grid = OccupancyGrid(HALL.cells.copy(), 0.05, HALL.origin)
    grid.cells[rows, columns] = Cell.OCCUPIED
    return grid


def test_a_step_cut_short_is_a_bump_and_a_full_one_is_not():
    before = Pose2(0.0, 0.0, 0.0)
    assert len(bumped(None, before)) == 0
    forward = (before, Action.MOVE_FORWARD)
    assert len(bumped(forward, Pose2(0.5, 0.0, 0.0))) == 0
    points = bumped(forward, Pose2(0.1, 0.0, 0.0))
    assert len(points) > 0
    # Ahead of the robot, at its edge or beyond.
    assert (points[:, 0] > 0.25).all()
    assert (np.hypot(points[:, 0] - 0.1, points[:, 1]) > 0.18).all()
    assert len(bumped((before, Action.TURN_LEFT), before)) == 0


def test_what_stands_beside_the_robot_is_what_it_touches():
    grid = with_obstacle(slice(105, 110), slice(95, 115))  # to the left, 0.25 m away
    before = Pose2(-0.1, 0.0, 0.0)
    points = bumped((before, Action.MOVE_FORWARD), Pose2(0.0, 0.0, 0.0), grid)
    assert len(points) > 0
    assert (points[:, 1] > 0.1).all()  # the path ahead and to the right stays open


def test_it_touches_nothing_where_its_body_has_just_been():
    grid = with_obstacle(slice(105, 110), slice(95, 115))
    here = Pose2(0.0, 0.0, 0.0)
    forward = (here, Action.MOVE_FORWARD)
    from_left = [(0.4, 0.4), here.xy]  # past the obstacle, which is seen a little too large
    points = bumped(forward, here, grid, way=from_left)
    assert len(points) > 0
    assert all(_away_m(point, *from_left) >= 0.18 for point in points)
    assert (points[:, 1] < 0.1).all()


def test_where_the_robot_did_not_drive_may_be_something():
    here = Pose2(0.0, 0.0, 0.0)
    forward = (here, Action.MOVE_FORWARD)
    carried = [(3.0, 0.0), here.xy]
    assert np.array_equal(bumped(forward, here, way=carried), bumped(forward, here))


def test_something_may_have_come_into_its_way():
    here = Pose2(0.0, 0.0, 0.0)
    came = [(0.4, 0.0), (0.2, 0.2), (0.2, -0.2), here.xy]
    assert len(bumped((here, Action.MOVE_FORWARD), here, way=came)) > 0


def test_switched_off_it_notices_nothing():
    before, off = Pose2(0, 0, 0), PlanningConfig(bump_sensor=False)
    assert len(bumped((before, Action.MOVE_FORWARD), before, config=off)) == 0


def _away_m(point, start, end) -> float:
    """Distance of a point from the leg between two positions, metres."""
    leg, away = np.subtract(end, start), np.subtract(point, start)
    return float(np.linalg.norm(away - np.clip(away @ leg / (leg @ leg), 0.0, 1.0) * leg))
