"""Noticing that the robot ran into something."""

import numpy as np

from drawn_grids import drawn
from hypernav.core.actions import Action
from hypernav.core.embodiment import Embodiment
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.planning.bump_sensor import bumped_points
from hypernav.planning.config import PlanningConfig

ROBOT = (PlanningConfig(), Embodiment())
HALL = drawn("....................\n" * 20, scale=10, origin=(-5.0, -5.0))


def test_a_step_cut_short_is_a_bump_and_a_full_one_is_not():
    before = Pose2(0.0, 0.0, 0.0)
    assert len(bumped_points(None, before, HALL, *ROBOT)) == 0
    forward = (before, Action.MOVE_FORWARD)
    assert len(bumped_points(forward, Pose2(0.5, 0.0, 0.0), HALL, *ROBOT)) == 0
    points = bumped_points(forward, Pose2(0.1, 0.0, 0.0), HALL, *ROBOT)
    assert len(points) > 0
    # Ahead of the robot, at its edge or beyond.
    assert (points[:, 0] > 0.25).all()
    assert (np.hypot(points[:, 0] - 0.1, points[:, 1]) > 0.18).all()
    assert len(bumped_points((before, Action.TURN_LEFT), before, HALL, *ROBOT)) == 0


def test_what_stands_beside_the_robot_is_what_it_touches():
    grid = OccupancyGrid(HALL.cells.copy(), 0.05, HALL.origin)
    grid.cells[105:110, 95:115] = Cell.OCCUPIED  # to the left, 0.25 m away
    before = Pose2(-0.1, 0.0, 0.0)
    points = bumped_points((before, Action.MOVE_FORWARD), Pose2(0.0, 0.0, 0.0), grid, *ROBOT)
    assert len(points) > 0
    assert (points[:, 1] > 0.1).all()  # the path ahead and to the right stays open


def test_switched_off_it_notices_nothing():
    before, off = Pose2(0, 0, 0), PlanningConfig(bump_sensor=False)
    forward = (before, Action.MOVE_FORWARD)
    assert len(bumped_points(forward, before, HALL, off, Embodiment())) == 0
