"""Laws of pure pursuit, in a closed loop with a robot that does exactly what it is told."""

import math
import re
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from hypernav.core.embodiment import BodyConfig
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2, wrap_angle
from hypernav.robot.driving.base import STANDSTILL, Velocity
from hypernav.robot.driving.driven_robot import CAREFUL
from hypernav.robot.driving.obstacles import MapObstacles, Obstacles, PointObstacles
from hypernav.robot.driving.pure_pursuit import DriveConfig, PurePursuit
from hypernav.search.planning.config import PlanningConfig
from hypernav.search.planning.planner import Planner

TICK_S = 0.1
CONFIG = DriveConfig()
RADIUS_M = 0.18
ROUNDING = 1e-9

angles = st.floats(-math.pi, math.pi)
coordinates = st.floats(-3.0, 3.0)
poses = st.builds(Pose2, coordinates, coordinates, angles)
velocities = st.builds(Velocity, st.floats(0.0, 1.0), st.floats(-2.0, 2.0))


def drive(
    robot: Pose2,
    path: list[tuple[float, float]],
    *,
    seconds: float = 60.0,
    obstacles: Obstacles | None = None,
    config: DriveConfig = CONFIG,
) -> tuple[list[Pose2], list[Velocity]]:
    pursuit = PurePursuit(config, RADIUS_M)
    driven, commands = [robot], [STANDSTILL]
    for _ in range(round(seconds / TICK_S)):
        commands.append(pursuit.command(driven[-1], path, TICK_S, obstacles))
        driven.append(commands[-1].moved(driven[-1], TICK_S))
        if pursuit.has_arrived(driven[-1], path) and commands[-1].is_zero:
            break
    return driven, commands


def within_limits(commands: list[Velocity], config: DriveConfig = CONFIG) -> bool:
    speeds = np.array([command.linear_m_s for command in commands])
    rates = np.array([command.angular_rad_s for command in commands])
    return bool(
        (speeds >= 0.0).all()
        and (speeds <= config.max_speed_m_s + ROUNDING).all()
        and (abs(rates) <= config.max_turn_rate + ROUNDING).all()
        and (abs(np.diff(speeds)) <= config.max_acceleration_m_s2 * TICK_S + ROUNDING).all()
        and (abs(np.diff(rates)) <= config.max_turn_acceleration * TICK_S + ROUNDING).all()
    )


def off_path(robot: Pose2, path: list[tuple[float, float]]) -> float:
    distances = []
    for start, end in pairwise(path):
        a, line = np.array(start), np.array(end) - np.array(start)
        share = np.clip((np.array(robot.xy) - a) @ line / (line @ line), 0.0, 1.0)
        distances.append(float(np.hypot(*(np.array(robot.xy) - a - share * line))))
    return min(distances)


@given(poses, velocities, st.floats(0.0, 2.0), st.floats(0.0, 2.0))
def test_two_drives_with_one_velocity_are_one_longer_drive(pose, velocity, first_s, second_s):
    apart = velocity.moved(velocity.moved(pose, first_s), second_s)
    at_once = velocity.moved(pose, first_s + second_s)
    assert apart.distance_to(*at_once.xy) < 1e-9
    assert abs(wrap_angle(apart.yaw - at_once.yaw)) < 1e-9


@settings(max_examples=50)
@given(poses, st.lists(st.tuples(coordinates, coordinates), min_size=1, max_size=6))
def test_velocities_stay_within_all_limits(robot, path):
    _, commands = drive(robot, path, seconds=8.0)
    assert within_limits(commands)


@given(
    st.lists(poses, min_size=1, max_size=30),
    st.lists(st.tuples(coordinates, coordinates), min_size=1, max_size=4),
)
def test_a_pose_that_jumps_does_not_make_velocities_jump(poses, path):
    pursuit = PurePursuit(CONFIG, RADIUS_M)
    assert within_limits([STANDSTILL, *(pursuit.command(pose, path, TICK_S) for pose in poses)])


@given(angles.filter(lambda angle: abs(angle) > 0.01), poses)
def test_the_sign_of_a_rotation_is_that_of_the_bearing(bearing, robot):
    """REP 103: counter-clockwise, to the left, is positive."""
    aim = (
        robot.x + 2.0 * math.cos(robot.yaw + bearing),
        robot.y + 2 * math.sin(robot.yaw + bearing),
    )
    command = PurePursuit(CONFIG, RADIUS_M).command(robot, [robot.xy, aim], TICK_S)
    assert command.angular_rad_s * bearing > 0.0 or abs(bearing) > math.pi - 0.01


@settings(max_examples=40)
@given(st.floats(-0.4, 0.4), angles)
def test_it_converges_onto_a_straight_path(beside_m, yaw):
    path = [(0.0, 0.0), (5.0, 0.0)]
    driven, commands = drive(Pose2(0.0, beside_m, yaw), path)
    assert commands[-1].is_zero
    assert driven[-1].distance_to(5.0, 0.0) <= CONFIG.arrival_m + 0.01
    assert all(abs(pose.y) < 0.03 for pose in driven if pose.x > 3.0)


@pytest.mark.slow
@settings(max_examples=40)
@given(angles, st.floats(math.radians(5.0), math.radians(175.0)), st.sampled_from([-1, 1]))
def test_it_drives_around_a_corner_and_stays_near_the_path(heading, bend, side):
    start = Pose2(0.0, 0.0, heading)
    corner = (2.0 * math.cos(heading), 2.0 * math.sin(heading))
    after = heading + side * bend
    end = (corner[0] + 2.0 * math.cos(after), corner[1] + 2.0 * math.sin(after))
    path = [start.xy, corner, end]
    driven, commands = drive(start, path)
    assert driven[-1].distance_to(*end) <= CONFIG.arrival_m + 0.01
    assert max(off_path(pose, path) for pose in driven) < 0.1
    assert within_limits(commands)


@settings(max_examples=12)
@given(st.integers(0, 2**32 - 1))
def test_it_never_drives_nearer_to_an_obstacle_than_its_radius(seed):
    """Whatever the path: here it leads to and fro among random obstacles, straight through them."""
    rng = np.random.default_rng(seed)
    grid = _cluttered(rng)
    obstacles = MapObstacles(grid)
    path = [(0.0, 0.0), *map(tuple, rng.uniform(-1.9, 1.9, (4, 2)).tolist())]
    driven, commands = drive(
        Pose2(0.0, 0.0, rng.uniform(-3, 3)), path, seconds=15.0, obstacles=obstacles
    )
    distances = obstacles.distances(np.array([pose.xy for pose in driven]))
    # The cell that a position falls into changes by half a diagonal.
    assert distances.min() > RADIUS_M - grid.resolution_m
    assert all(grid.state_at(*pose.xy) is not Cell.OCCUPIED for pose in driven)
    assert (np.diff([command.linear_m_s for command in commands]) <= 0.05 + ROUNDING).all()


@pytest.mark.parametrize("preset", ["corners", "dense"])
@pytest.mark.parametrize("seed", range(10))
def test_it_arrives_wherever_a_path_was_planned(seed, preset):
    rng = np.random.default_rng(seed)
    grid = _cluttered(rng)
    planner = Planner(PlanningConfig(waypoints=preset, max_gap_m=None), BodyConfig())
    path = planner.plan(grid, (0.0, 0.0), rng.uniform(-1.8, 1.8, (1, 2)))
    assert path is not None
    driven, _ = drive(
        Pose2(0.0, 0.0, 0.0), list(path.waypoints), obstacles=MapObstacles(grid), seconds=120.0
    )
    assert driven[-1].distance_to(*path.end) <= CONFIG.arrival_m + 0.01


@settings(max_examples=40)
@given(angles, st.floats(0.3, 1.6), st.floats(math.radians(150.0), math.radians(210.0)))
@example(-2.38, 0.509, -3.126)
@example(0.91, 0.672, 3.114)
@example(0.0, 0.34375, -3.140625)
def test_where_its_path_leads_back_it_goes_back(yaw, length_m, bend):
    path = [(-length_m, 0.0), (0.0, 0.0), (math.cos(bend), math.sin(bend))]
    driven, commands = drive(Pose2(-length_m, 0.0, yaw), path, seconds=40.0)
    assert driven[-1].distance_to(*path[-1]) <= CONFIG.arrival_m + 0.01
    assert within_limits(commands)


nearby = st.floats(-0.06, 0.06)


@settings(max_examples=20)
@given(nearby, nearby, angles)
@example(-0.0208, -0.0509, 2.3363)
def test_past_a_doors_frame_it_does_not_turn_to_and_fro(x, y, yaw):
    """From one heading an arc is barred, from the next it is free: it must make up its mind."""
    along = np.linspace(0.0, 0.9, 50)
    wall = np.column_stack([0.3858 + along, np.full(50, 0.189)])
    frame = PointObstacles(np.vstack([wall, np.column_stack([np.full(50, 0.3858), 0.189 + along])]))
    path = [(-0.1452, -0.3607), (0.0, 0.0), (0.5, -0.0382), (2.0, -1.2)]
    careful = DriveConfig(margin_m=0.03)
    driven, _ = drive(Pose2(x, y, yaw), path, obstacles=frame, config=careful, seconds=30.0)
    assert driven[-1].distance_to(*path[-1]) <= CONFIG.arrival_m + 0.01


def test_it_is_slower_beside_obstacles():
    wall = np.stack([np.linspace(-1.0, 6.0, 200), np.full(200, 0.25)], axis=1)
    path = [(0.0, 0.0), (5.0, 0.0)]
    _, beside = drive(Pose2(0.0, 0.0, 0.0), path, obstacles=PointObstacles(wall))
    _, free = drive(Pose2(0.0, 0.0, 0.0), path)
    fastest = max(command.linear_m_s for command in free)
    assert fastest == pytest.approx(CONFIG.max_speed_m_s)
    assert 0.0 < max(command.linear_m_s for command in beside) < 0.6 * fastest


def test_an_obstacle_that_appears_stops_it_at_once():
    pursuit, robot = PurePursuit(CONFIG, RADIUS_M), Pose2(0.0, 0.0, 0.0)
    path = [(0.0, 0.0), (5.0, 0.0)]
    commands = []
    for _ in range(20):
        commands.append(pursuit.command(robot, path, TICK_S))
        robot = commands[-1].moved(robot, TICK_S)
    assert commands[-1].linear_m_s == pytest.approx(CONFIG.max_speed_m_s)
    person = PointObstacles(np.array([[robot.x + RADIUS_M + 0.01, 0.0]]))
    assert pursuit.command(robot, path, TICK_S, person).linear_m_s == 0.0


def test_a_rotation_ends_where_it_should():
    pursuit, left = PurePursuit(CONFIG, RADIUS_M), math.radians(-30.0)
    commands = [STANDSTILL]
    for _ in range(50):
        commands.append(pursuit.rotate(left, TICK_S))
        left -= commands[-1].angular_rad_s * TICK_S
    assert abs(left) < math.radians(0.1)
    assert within_limits(commands)


def _cluttered(rng: np.random.Generator) -> OccupancyGrid:
    """A closed square of 4 m with boxes in it, and room for the robot in the middle."""
    cells = np.full((80, 80), Cell.FREE, dtype=np.uint8)
    for row, column in rng.integers(0, 76, (12, 2)):
        cells[row : row + 4, column : column + 4] = Cell.OCCUPIED
    cells[32:48, 32:48] = Cell.FREE
    cells[[0, -1]] = Cell.OCCUPIED
    cells[:, [0, -1]] = Cell.OCCUPIED
    return OccupancyGrid(cells, 0.05, (-2.0, -2.0))


def test_a_command_that_holds_too_long_leaves_room_to_brake():
    config, wall = DriveConfig(reaction_s=0.6), PointObstacles(np.array([[1.5, 0.0]]))
    path = [(0.0, 0.0), (3.0, 0.0)]
    driven, commands = drive(
        Pose2(0.0, 0.0, 0.0), path, seconds=10.0, obstacles=wall, config=config
    )
    for robot, command in zip(driven[:-1], commands[1:], strict=True):
        speed = command.linear_m_s
        held_m = speed * (TICK_S + config.reaction_s)
        braked_m = speed**2 / (2.0 * config.max_acceleration_m_s2)
        assert robot.x + held_m + braked_m + RADIUS_M < 1.5 + ROUNDING
    assert driven[-1].x > 1.2


PAGE = Path(__file__).parents[3] / "docs" / "robot.md"


def test_the_page_about_robots_has_every_limit_and_its_default():
    section = PAGE.read_text().partition("The fields of `DriveConfig`")[2].partition("\n## ")[0]
    written: dict[str, float] = {}
    for fields, defaults in re.findall(r"^\| (`.*?) \| (.*?) \|", section, re.MULTILINE):
        names = re.findall(r"`(\w+)`", fields)
        values = [float(value) for value in re.findall(r"\d[\d.]*", defaults.partition(";")[0])]
        written |= dict(zip(names, values, strict=True))
    assert written == DriveConfig().model_dump()
    assert f"0; {CAREFUL.margin_m} in `DrivenRobot`" in section
