"""Steps over stairs stay on the ground, keep off its edges and come nearer."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hypernav.core.embodiment import Action, MotionConfig
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.mapping.elevation_map import Ground, UnseenGround
from hypernav.search.planning.stair_steps import step_over_ground

MOTION = MotionConfig(forward_m=0.5, turn_angle_deg=30.0)
LENGTH_M, HALF_M = 6.0, 0.55


def flight(half_m: float = HALF_M) -> Ground:
    """A strip of ground along the x axis, as wide as a flight of stairs if not told else."""
    cells = np.full((40, 160), np.uint8(Cell.OCCUPIED))
    grid = OccupancyGrid(cells, 0.05, (-1.0, -1.0))
    x, y = np.moveaxis(grid.centres_of(np.argwhere(cells > 0)).reshape(40, 160, 2), 2, 0)
    clearance = np.minimum.reduce([half_m - np.abs(y), x + 0.5, LENGTH_M - x]).clip(0.0)
    cells[clearance > 0.0] = Cell.FREE
    known = clearance > 0.0
    return Ground(
        OccupancyGrid(cells, 0.05, (-1.0, -1.0)),
        np.where(known, 0.6 * x, np.nan).astype(np.float32),
        known,
        clearance > 0.12,
        np.zeros_like(known),
        0.12,
        UnseenGround(np.zeros_like(known), np.full(known.shape, np.nan, dtype=np.float32)),
        np.zeros_like(known),
    )


def end_of(ground: Ground) -> np.ndarray:
    return ground.reached & (ground.heights > 0.6 * (LENGTH_M - 1.0))


@given(y=st.floats(-0.3, 0.3), yaw=st.floats(-math.pi, math.pi))
def test_a_robot_walks_to_the_end_of_a_flight_and_never_off_it(y: float, yaw: float):
    ground, pose = flight(), Pose2(0.0, y, yaw)
    to = end_of(ground)
    for _ in range(40):
        action = step_over_ground(ground, pose, to, MOTION)
        if action is None:
            break
        if action is Action.MOVE_FORWARD:
            pose = pose.ahead(MOTION.forward_m)
            assert ground.clearance_m[ground.grid.cell_of(*pose.xy)] > 0.12
        else:
            turn = MOTION.turn_angle_deg if action is Action.TURN_LEFT else -MOTION.turn_angle_deg
            pose = Pose2(pose.x, pose.y, pose.yaw + math.radians(turn))
    assert pose.x > LENGTH_M - 1.5


def test_there_is_no_step_where_the_robot_stands_on_no_ground():
    ground = flight()
    assert step_over_ground(ground, Pose2(-0.9, 0.9, 0.0), end_of(ground), MOTION) is None


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_robot_that_touches_the_edge_turns_away_from_it_first(side: float):
    ground, pose = flight(), Pose2(3.0, side * 0.42, side * 0.3)
    action = step_over_ground(ground, pose, end_of(ground), MOTION, touching=True)
    assert action is (Action.TURN_RIGHT if side > 0 else Action.TURN_LEFT)


@settings(max_examples=30)
@given(side=st.sampled_from([-1.0, 1.0]), yaw=st.floats(-math.pi, math.pi))
def test_on_a_wide_landing_the_first_step_off_a_wall_leads_to_more_room(side: float, yaw: float):
    landing, pose = flight(half_m=0.95), Pose2(3.0, side * 0.5, yaw)
    to = landing.reached & (landing.distances_m((pose.x, side * 0.8)) < 0.2)  # beside the wall
    action = None
    for _ in range(MOTION.turns_of_a_circle):
        action = step_over_ground(landing, pose, to, MOTION, touching=True)
        if action is Action.MOVE_FORWARD:
            break
        turn = MOTION.turn_angle_deg if action is Action.TURN_LEFT else -MOTION.turn_angle_deg
        pose = Pose2(pose.x, pose.y, pose.yaw + math.radians(turn))
    assert action is Action.MOVE_FORWARD
    assert side * pose.ahead(MOTION.forward_m).y < 0.3


def test_no_step_is_tried_in_a_heading_that_leads_nowhere():
    """What stands in the way may be too low or too thin for the camera."""
    ground, pose = flight(), Pose2(3.0, 0.0, 0.0)
    to = end_of(ground)

    def after(*closed: int, touching: bool = False) -> Action | None:
        return step_over_ground(ground, pose, to, MOTION, touching=touching, closed=closed)

    assert after() is Action.MOVE_FORWARD
    assert after(0, 1) is Action.TURN_RIGHT
    assert after(0, -1) is Action.TURN_LEFT
    for touching in (False, True):
        assert after(0, touching=touching) is not Action.MOVE_FORWARD
        assert after(*range(-5, 7), touching=touching) is None


def test_a_step_keeps_off_a_corner_that_it_would_only_pass():
    ground, pose = flight(), Pose2(0.0, 0.0, 0.0)
    x, y = ground.grid.centres_of(np.argwhere(ground.seen | ~ground.seen)).T
    post = (np.hypot(x - 0.2, y - 0.3) < 0.1).reshape(ground.seen.shape)
    with_post = ground.without(post, pose.xy)
    assert step_over_ground(ground, pose, end_of(ground), MOTION) is Action.MOVE_FORWARD
    assert step_over_ground(with_post, pose, end_of(ground), MOTION) is Action.TURN_RIGHT


def test_a_robot_goes_on_where_the_way_gets_narrow():
    ground, robot = flight(), Pose2(1.0, 0.0, 0.0)
    rows, columns = ground.grid.cells.shape
    x, y = np.moveaxis(
        ground.positions(np.ones((rows, columns), np.bool_)).reshape(rows, columns, 2), 2, 0
    )
    narrow = ground.without((x > 1.4) & (np.abs(y) > 0.2), robot.xy)
    assert step_over_ground(narrow, robot, end_of(narrow), MOTION) is Action.MOVE_FORWARD
