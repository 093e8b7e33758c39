"""Planning and following in closed loop."""

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from certainty import certain
from drawn_grids import drawn
from hypernav.core.embodiment import Action, Embodiment, MotionConfig
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.mapping.grid_kernels import travel_cells
from hypernav.search.planning.bump_sensor import bumped_points
from hypernav.search.planning.config import PlanningConfig
from hypernav.search.planning.costmap import SURROUNDINGS_M, Costmap
from hypernav.search.planning.follower import PathFollower, Route, _surroundings
from hypernav.search.planning.navigator import Navigator
from hypernav.search.planning.planner import PlannedPath, Planner
from random_rooms import DrivenRobot, random_clutter, random_rooms

CONFIG = PlanningConfig()
ROBOT = Embodiment()
WIDE = PlanningConfig(squeeze_m=0.0)
CLEARANCE_M = ROBOT.body.radius_m + CONFIG.margin_m
PAPER = PlanningConfig(
    squeeze_m=0.0, comfort_cost=0.0, targets="nearest-straight", steering="waypoint"
)
HALL = drawn("....................\n" * 20, scale=10, origin=(-5.0, -5.0))
PATH = PlannedPath(((0.0, 0.0), (2.0, 0.0), (2.0, 2.0)), gap_m=0.0, cost=80.0, is_known=True)


class Following:
    """A follower, and the route that it replaces."""

    def __init__(self, path, config=PAPER):
        self._follower = PathFollower(config, MotionConfig())
        self.route = Route().along(path, CLEARANCE_M, config.waypoint_tolerance_m)

    def next_action(self, robot):
        action, self.route = self._follower.next_action(self.route, robot)
        return action


class Driver:
    """A navigator, and the route that it replaces."""

    def __init__(self, config):
        self._navigator = Navigator(config, ROBOT)
        self.route = Route()

    def towards(self, grid, robot, goal):
        action, self.route = self._navigator.towards(self.route, grid, robot, goal)
        return action


def test_the_robot_looks_equally_far_to_all_sides():
    robot = Pose2(0.3, -0.2, 0.0)
    wide = drawn(("." * 24 + "\n") * 24, scale=10, origin=(-6.0, -6.0))
    costmap = Costmap.of(wide, CONFIG, robot.xy, CLEARANCE_M)
    costs, corner = _surroundings(costmap, robot)
    reach = np.subtract(costmap.grid.cell_of(*robot.xy), corner)
    assert (reach * costmap.grid.resolution_m).tolist() == pytest.approx([SURROUNDINGS_M] * 2)
    assert costs.shape == tuple(2 * reach + 1)


@pytest.mark.parametrize(
    ("yaw_deg", "action"),
    [
        (0.0, Action.MOVE_FORWARD),
        (15.0, Action.MOVE_FORWARD),
        (-15.0, Action.MOVE_FORWARD),
        (15.1, Action.TURN_RIGHT),
        (-15.1, Action.TURN_LEFT),
        (179.0, Action.TURN_RIGHT),
        (-179.0, Action.TURN_LEFT),
    ],
)
def test_it_turns_if_the_next_waypoint_is_too_far_off_and_goes_otherwise(yaw_deg, action):
    assert Following(PATH).next_action(Pose2(0.0, 0.0, math.radians(yaw_deg))) is action


def test_a_waypoint_that_was_stepped_over_does_not_come_back():
    following = Following(
        PlannedPath(((0.0, 0.0), (0.7, 0.0), (3.0, 0.1)), gap_m=0.0, cost=60.0, is_known=True)
    )
    for x in (0.0, 0.4, 1.1, 1.6, 2.1):
        assert following.next_action(Pose2(x, 0.0, 0.0)) is Action.MOVE_FORWARD
    assert following.route.points_left(Pose2(1.6, 0.0, 0.0)) == ((1.6, 0.0), (3.0, 0.1))


def test_it_arrives_within_the_tolerance_and_not_before():
    following = Following(PATH)
    assert following.next_action(Pose2(2.0, 1.7, math.pi / 2)) is Action.MOVE_FORWARD
    assert not following.route.arrived
    assert following.next_action(Pose2(2.0, 1.8, math.pi / 2)) is None
    assert following.route.arrived


def test_it_does_not_turn_back_to_an_end_that_it_stepped_over():
    following = Following(PATH)
    assert following.next_action(Pose2(2.0, 1.7, math.pi / 2)) is Action.MOVE_FORWARD
    assert following.next_action(Pose2(2.13, 2.25, math.pi / 2)) is None
    assert following.route.arrived


def test_without_a_path_there_is_nothing_to_do():
    following = Following(None)
    assert following.next_action(Pose2(0.0, 0.0, 0.0)) is None
    assert not following.route.arrived
    assert following.route.points_left(Pose2(0.0, 0.0, 0.0)) == ()


@settings(deadline=None, max_examples=60)
@given(
    st.floats(-3.5, 3.5),
    st.floats(-3.5, 3.5),
    st.floats(-4.0, 4.0),
    st.sampled_from([CONFIG, PAPER]),
)
@example(x=-3.5, y=-3.5, yaw=1.0, config=PAPER)
@example(x=-3.25, y=-3.25, yaw=0.0, config=PAPER)  # turned around to an end 0.25 m behind it
@example(x=-1.25, y=0.0, yaw=0.75, config=PAPER)
@example(x=3.5, y=-3.5, yaw=2.61, config=PAPER)
def test_over_open_floor_it_arrives_without_dithering(x, y, yaw, config):
    robot, navigator = DrivenRobot(HALL, Pose2(0.0, 0.0, yaw)), Driver(config)
    actions = []
    while len(actions) < 80:
        action = navigator.towards(HALL, robot.pose, np.array([[x, y]]))
        if action is None:
            break
        actions.append(action)
        robot.do(action)
    assert navigator.route.arrived
    # Where steps of half a metre cannot come nearer, half a step and its sideways error remain.
    assert robot.pose.distance_to(x, y) <= 0.36
    least = math.hypot(x, y)
    assert robot.travelled_m <= 1.1 * least + 0.75
    letters = {Action.MOVE_FORWARD: "F", Action.TURN_LEFT: "L", Action.TURN_RIGHT: "R"}
    drive = "".join(letters[one] for one in actions)
    assert "LR" not in drive
    assert "RL" not in drive
    at_first, *later = (len(turns) for turns in drive.split("F"))
    assert at_first <= 6  # half a circle
    if config is PAPER:
        # A bearing halfway between two headings is corrected after every step.
        assert max(later, default=0) <= 1
    else:
        # A correction a metre, and a few at the end, where the error of a step is a wide angle.
        assert sum(later) <= least + 4


def random_drive(rng, costmap):
    """Two random open cells with more than 2 m of path between them."""
    starts = np.argwhere(costmap.is_open)
    while True:
        start = starts[rng.integers(len(starts))]
        travel = travel_cells(costmap.is_open, *map(int, start))
        ends = np.argwhere(np.isfinite(travel) & (travel > 40))
        if len(ends) > 0:
            return start.tolist(), ends[rng.integers(len(ends))].tolist()


def drive_to_the_end(robot, grid, goal, config, *, limit=300):
    """Drive until the navigator knows no further action; the actions."""
    navigator = Driver(config)
    known = OccupancyGrid(grid.cells.copy(), grid.resolution_m, grid.origin)
    done, ordered, track = [], None, []
    for _ in range(limit):
        track.append(robot.pose.xy)
        for x, y in bumped_points(ordered, robot.pose, track, known, config, ROBOT):
            known.cells[known.cell_of(x, y)] = Cell.OCCUPIED
        action = navigator.towards(known, robot.pose, goal)
        if action is None:
            return done
        ordered = (robot.pose, action)
        robot.do(action)
        done.append(action)
    raise AssertionError(f"still driving after {limit} actions")


def drive(seed, config, *, door_m, limit=300, actions=None):
    """Drive from one random position to another in random rooms."""
    rng = np.random.default_rng(seed)
    grid = random_rooms(rng, door_m=door_m)
    costmap = Costmap.of(grid, CONFIG, (0.0, 0.0), CLEARANCE_M)
    start, end = random_drive(rng, costmap)
    goal = np.array([costmap.grid.centre_of(*end)])
    pose = Pose2(*costmap.grid.centre_of(*start), rng.uniform(-math.pi, math.pi))
    robot = DrivenRobot(grid, pose)
    done = drive_to_the_end(robot, grid, goal, config, limit=limit)
    if actions is not None:
        actions += done
    planned = certain(Planner(config, ROBOT.body).plan(grid, pose.xy, goal))
    return robot, robot.pose.distance_to(*goal[0]), planned.length_m


@settings(deadline=None, max_examples=25, derandomize=True)
@given(st.integers(0, 2**32 - 1), st.floats(0.55, 1.0))
def test_it_never_touches_what_the_map_shows_and_always_comes_to_an_end(seed, door_m):
    """These 25 drives; of 3,757 random ones two touched something, as the two below do."""
    robot, _, _ = drive(seed, WIDE, door_m=door_m)
    assert robot.bumps == 0


@pytest.mark.xfail(reason="the costmap measures between the middles of cells", strict=True)
@pytest.mark.parametrize(("seed", "door_m"), [(87, 0.75), (1141497737, 0.84375)])
def test_it_touches_nothing_where_a_step_ends_at_the_edge_of_a_cell(seed, door_m):
    robot, _, _ = drive(seed, WIDE, door_m=door_m)
    assert robot.bumps == 0


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 2**32 - 1))
@example(29)  # in these the wider path leads to a dead end, and the way out of it goes back
@example(236)
@example(355)
@example(762)
def test_it_does_not_go_to_and_fro_between_a_wider_path_and_a_squeezed_one(seed):
    rng = np.random.default_rng(seed)
    grid = random_clutter(rng)
    robot = DrivenRobot(grid, Pose2(0.0, 0.0, rng.uniform(-3.1, 3.1)), radius_m=0.1)
    row, column = rng.choice(np.argwhere(grid.free))
    goal = np.array([grid.centre_of(int(row), int(column))])
    drive_to_the_end(robot, grid, goal, CONFIG)  # which comes


@pytest.mark.parametrize("door_m", [0.65, 0.8])
def test_it_gets_through_doors_and_around_furniture(door_m):
    outcomes = [drive(seed, CONFIG, door_m=door_m) for seed in range(30)]
    there = [off <= 0.36 for _, off, _ in outcomes]
    assert sum(there) >= 29
    detours = [r.travelled_m / planned for r, off, planned in outcomes if off <= 0.36]
    assert np.mean(detours) < 1.15


def test_where_turns_are_dear_there_are_fewer_and_the_path_is_hardly_longer():
    turns, length_m = [], []
    for turn_cost_m in (0.0, 0.2):
        config, actions = PlanningConfig(turn_cost_m=turn_cost_m), []
        drives = [drive(seed, config, door_m=0.9, actions=actions) for seed in range(12)]
        turns.append(sum(action is not Action.MOVE_FORWARD for action in actions))
        length_m.append(sum(robot.travelled_m for robot, _, _ in drives))
    assert turns[1] < 0.9 * turns[0]
    assert length_m[1] < 1.05 * length_m[0]


def test_the_papers_follower_gets_through_doors_too():
    outcomes = [drive(seed, PAPER, door_m=0.9) for seed in range(20)]
    assert sum(off <= 0.5 for _, off, _ in outcomes) >= 17


def test_a_path_that_becomes_blocked_is_planned_anew():
    navigator, goal = Driver(CONFIG), np.array([[4.0, 0.0]])
    grid = OccupancyGrid(HALL.cells.copy(), 0.05, HALL.origin)
    navigator.towards(grid, Pose2(-4.0, 0.0, 0.0), goal)
    before = navigator.route.path
    navigator.towards(grid, Pose2(-3.5, 0.0, 0.0), goal)
    assert navigator.route.path is before
    grid.cells[80:120, 100:104] = Cell.OCCUPIED
    navigator.towards(grid, Pose2(-3.0, 0.0, 0.0), goal)
    assert navigator.route.path is not before
    assert certain(navigator.route.path).length_m > 7.3


def test_a_path_is_planned_anew_after_so_many_steps():
    navigator, goal = Driver(CONFIG), np.array([[4.0, 0.0]])
    paths = []
    for _ in range(25):
        navigator.towards(HALL, Pose2(-4.0, 0.0, 0.0), goal)
        paths.append(navigator.route.path)
    assert len({id(path) for path in paths}) == 3


def test_a_path_may_be_kept_to_its_end():
    navigator, goal = Driver(PlanningConfig(replan_every_steps=None)), [[4.0, 0.0]]
    paths = set()
    for _ in range(25):
        navigator.towards(HALL, Pose2(-4.0, 0.0, 0.0), np.array(goal))
        paths.add(id(navigator.route.path))
    assert len(paths) == 1


def test_no_way_is_not_an_arrival():
    grid = OccupancyGrid(HALL.cells.copy(), 0.05, HALL.origin)
    grid.cells[:, 100:110] = Cell.OCCUPIED
    navigator = Driver(PlanningConfig(unknown_cost=0.0))
    assert navigator.towards(grid, Pose2(-2.0, 0.0, 0.0), np.array([[3.0, 0.0]])) is None
    assert not navigator.route.arrived
    assert navigator.route.remaining(Pose2(-2.0, 0.0, 0.0)) == []


def test_the_same_situation_gives_the_same_actions():
    def actions():
        robot, navigator = DrivenRobot(HALL, Pose2(0.0, 0.0, 1.0)), Driver(CONFIG)
        for _ in range(12):
            action = navigator.towards(HALL, robot.pose, np.array([[3.0, -2.0]]))
            if action is None:
                return
            yield action
            robot.do(action)

    driven = list(actions())
    assert Action.MOVE_FORWARD in driven
    assert list(actions()) == driven


def test_a_destination_that_moves_keeps_its_path_where_so_configured():
    area = np.array([[3.0, 0.0], [3.0, 0.5], [3.5, 0.0], [3.5, 0.5]])
    for replans in (True, False):
        navigator = Driver(PlanningConfig(replan_when_moved=replans))
        navigator.towards(HALL, Pose2(-4.0, 0.0, 0.0), area)
        before = navigator.route.path
        navigator.towards(HALL, Pose2(-3.5, 0.0, 0.0), area + 0.2)
        assert (navigator.route.path is before) != replans
        navigator.towards(HALL, Pose2(-3.5, 0.0, 0.0), -area)  # another destination
        assert navigator.route.path is not before
