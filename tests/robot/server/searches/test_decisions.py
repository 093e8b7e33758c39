"""What a robot is told: clearance and velocity agree with the map and the action."""

import math

import numpy as np
import pytest

from hypernav.core.embodiment import Action, Embodiment
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.trace import Ending, Mode, StepTrace
from hypernav.robot.server.searches.decisions import reply_of
from hypernav.robot.wire.replies import Reply

ROBOT = Embodiment()


def reply(
    wall_x: float | None = None, path=(), action: Action | None = Action.MOVE_FORWARD, **values
) -> Reply:
    cells = np.full((100, 100), Cell.FREE, np.uint8)
    grid = OccupancyGrid(cells, 0.05, (-2.5, -2.5))
    if wall_x is not None:
        cells[:, grid.cell_of(wall_x, 0.0)[1]] = Cell.OCCUPIED
    values = {"pose": (0.0, 0.0, 0.0), "mode": Mode.EXPLORE, "path": list(path)} | values
    return reply_of(4, StepTrace(step=4, action=action, **values), grid, ROBOT)


@pytest.mark.parametrize("wall_x", [0.5, 1.0, 2.0, -1.5])
def test_clearance_is_the_distance_of_the_nearest_obstacle(wall_x):
    assert reply(wall_x).clearance_m == pytest.approx(abs(wall_x), abs=0.06)


def test_an_empty_map_has_no_clearance():
    assert reply().clearance_m is None
    assert reply(1.0, pose=(400.0, 0.0, 0.0)).clearance_m is None


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_velocity_leads_along_the_path(side):
    ahead = reply(path=[(0.0, 0.0), (2.0, 0.0)]).velocity
    assert ahead is not None
    assert ahead.linear_m_s > 0.2
    assert ahead.angular_rad_s == pytest.approx(0.0)
    aside = reply(path=[(0.0, 0.0), (0.0, 2.0 * side)]).velocity
    assert aside is not None
    assert aside.linear_m_s == pytest.approx(0.0)
    assert math.copysign(1.0, aside.angular_rad_s) == side


def test_the_velocity_is_lower_beside_a_wall():
    path = [(0.0, 0.0), (0.0, 2.0)]
    free = reply(path=path, pose=(0.0, 0.0, math.pi / 2)).velocity
    near = reply(0.35, path=path, pose=(0.0, 0.0, math.pi / 2)).velocity
    assert free is not None
    assert near is not None
    assert near.linear_m_s < free.linear_m_s


@pytest.mark.parametrize(("action", "sign"), [(Action.TURN_LEFT, 1.0), (Action.TURN_RIGHT, -1.0)])
def test_a_turn_without_a_path_is_a_rotation(action, sign):
    velocity = reply(action=action).velocity
    assert velocity is not None
    assert velocity.linear_m_s == 0.0
    assert math.copysign(1.0, velocity.angular_rad_s) == sign
    assert velocity.angular_rad_s != 0.0


def test_the_end_has_no_velocity():
    for action in (Action.STOP, None):
        last = reply(path=[(0.0, 0.0), (1.0, 0.0)], action=action, ending=Ending.of(action))
        assert (last.velocity, last.action, last.done) == (None, Action.STOP, True)
