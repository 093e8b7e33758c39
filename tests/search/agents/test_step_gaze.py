"""Which turns are worth making."""

import math
from dataclasses import replace

import numpy as np
import pytest

from drawn_grids import drawn
from hypernav.core.embodiment import Action, CameraConfig, Embodiment
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.agents.step import Gaze

# A closed room but for an opening in the upper wall.
ROOM = """
    ????????????
    ????????????
    ????????????
    #####..#####
    #..........#
    #..........#
    #..........#
    #..........#
    ############
"""
MIDDLE = (3.0, 1.75)
UP = math.pi / 2


def room():
    return drawn(ROOM, scale=10)


def turns_from(yaw, grid, least_m2=1.0, embodiment=None):
    """The turns that are made one after the other where the map never changes, and the heading."""
    embodiment = embodiment or Embodiment()
    turn = math.radians(embodiment.motion.turn_angle_deg)
    gaze, robot, turns = Gaze(embodiment, least_m2), Pose2(*MIDDLE, yaw), []
    looked = None
    while len(turns) < 50:
        looked = gaze.after_image(looked, robot)
        action = gaze.worthwhile_turn(grid, robot, looked)
        if action is None:
            break
        turns.append(action)
        robot = Pose2(*MIDDLE, robot.yaw + (turn if action is Action.TURN_LEFT else -turn))
    return turns, robot


@pytest.mark.parametrize("yaw", [0.0, 2.0, math.pi, -2.0, -UP])
def test_it_turns_the_short_way_to_the_opening_and_stops_there(yaw):
    turns, robot = turns_from(yaw, room())
    assert abs(robot.bearing_to(3.0, 2.75)) <= math.radians(45.0)
    assert len(set(turns)) <= 1
    assert len(turns) <= 6


def test_what_was_looked_at_is_not_looked_at_again():
    assert turns_from(UP, room())[0] == []


def test_where_nothing_is_known_it_turns_around_until_all_was_in_an_image():
    nowhere = drawn("?", scale=10)
    turns, _ = turns_from(0.0, nowhere, least_m2=0.1)
    assert len(turns) == math.ceil((360.0 - 79.0) / 30.0)
    assert len(set(turns)) == 1


@pytest.mark.parametrize("pitch_deg", [0.0, 20.0])
def test_what_lies_below_the_image_is_worth_no_turn(pitch_deg: float):
    embodiment = Embodiment(camera=CameraConfig(pitch_deg=pitch_deg))
    lens, below = embodiment.camera.intrinsics, math.radians(pitch_deg)
    nearest_m = embodiment.camera.height_m / math.tan(below + math.atan(lens.height / 2 / lens.fy))
    cells = np.full((160, 160), np.uint8(Cell.OCCUPIED))
    cells[1:-1, 1:-1] = Cell.FREE
    grid = OccupancyGrid(cells, 0.05, (MIDDLE[0] - 4.0, MIDDLE[1] - 4.0))
    away_m = np.hypot(*(np.indices(cells.shape) - 79.5)) * 0.05
    for low, high, turns in ((0.6, 0.9, False), (1.1, 1.4, True)):
        ring = (away_m > low * nearest_m) & (away_m < high * nearest_m)
        unknown = np.where(ring, np.uint8(Cell.UNKNOWN), cells)
        found, _ = turns_from(0.0, replace(grid, cells=unknown), 0.05, embodiment)
        assert bool(found) is turns


def test_too_little_is_not_worth_a_turn():
    assert turns_from(-UP, room(), least_m2=50.0)[0] == []


def test_another_position_is_looked_from_anew():
    gaze, grid = Gaze(Embodiment(), 1.0), room()
    looked = gaze.after_image(None, Pose2(*MIDDLE, UP))
    down = Pose2(MIDDLE[0] - 0.5, MIDDLE[1], -UP)
    assert gaze.worthwhile_turn(grid, down, gaze.after_image(looked, down)) is not None


def test_a_camera_that_sees_no_floor_in_its_range_has_nothing_to_look_for():
    high = Embodiment(camera=CameraConfig(height_m=5.0, pitch_deg=-60.0))
    assert turns_from(0.0, drawn("?", scale=10), embodiment=high)[0] == []


def test_every_image_shows_as_much_as_its_camera_is_wide():
    wide = Embodiment(camera=CameraConfig(hfov_deg=120.0))
    narrow, wider = (len(turns_from(0.0, drawn("?"), embodiment=e)[0]) for e in (None, wide))
    assert wider < narrow
    assert np.isclose(wider, (360.0 - 120.0) / 30.0, atol=1.0)
