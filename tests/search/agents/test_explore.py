"""How a destination of global perception ends."""

import math
from itertools import pairwise

import numpy as np
import pytest

from certainty import certain
from drawn_grids import drawn
from hypernav.core.embodiment import Action, CameraConfig, Embodiment, MotionConfig
from hypernav.core.exploring.exploration import Destination
from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import ExchangeLog, ModuleClock
from hypernav.search.agents.config import SearchConfig
from hypernav.search.agents.explore import explore, unexplored_boundary
from hypernav.search.agents.plan import Plan
from hypernav.search.agents.step import Decision, Phase, SearchComponents, Step, turn_towards
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.memory.memory import Memory
from hypernav.search.perception.config import LocalConfig
from hypernav.search.perception.local.depth_cut import DepthCutSegmenter
from hypernav.search.perception.local.local_perception import LocalPerception
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from hypernav.search.planning.config import PlanningConfig
from images import thing_before_wall

# A corridor from the left to the right, 2 m wide, and a dark door in the middle of its upper wall.
CORRIDOR = """
    ????????????????
    #######??#######
    ................
    ................
    ................
    ................
    ################
"""
DOOR = (4.0, 2.4)
# What lies behind the door, of which only the far wall was seen.
UNKNOWN_HALL = """
    ??????####??????
    ????????????????
    ????????????????
    ????????????????
    ????????????????
    ????????????????
"""


class Once:
    """An explorer with one destination."""

    def __init__(self, position, face=None):
        self._left = [Destination(*position, reason="there", face=face)]

    def next_destination(self, view):
        return self._left.pop() if self._left else None


def corridor():
    return drawn(CORRIDOR, scale=10)


def frame_of(robot):
    """What the robot sees does not matter here."""
    camera = PinholeCamera.from_hfov(4, 3, 79.0)
    return Observation(
        rgb=np.zeros((3, 4, 3), dtype=np.uint8),
        depth=np.zeros((3, 4), dtype=np.float32),
        camera=camera,
        camera_to_map=robot.to_transform() @ optical_to_base(0.88),
        robot=robot,
    )


def perception():
    return LocalPerception(
        GroundTruthDetector(), DepthCutSegmenter(), LocalConfig(), CameraConfig(), cell_size_m=0.05
    )


class Exploration:
    """The exploration phase with its memory and plan, step by step."""

    def __init__(self, explorer, *, memory=None, **options):
        self.memory = memory or Memory(MappingConfig(), Embodiment())
        self.events = []
        self._use = SearchComponents(
            mapping=MappingConfig(),
            local=perception(),
            explorer=explorer,
            planning=PlanningConfig(),
            embodiment=Embodiment(),
            presence=None,
            image_recall=None,
            image_ranking=None,
            log=ExchangeLog(),
            config=SearchConfig(**{"least_unseen_m2": None, **options}),
        )
        self.plan = Plan.at_start(self._use.paced, turns=0)

    def act(self, robot, grid):
        frame, clock = frame_of(robot), ModuleClock()
        step = Step(0, Goal("bed"), frame, grid, self._use, clock, self.events)
        outcome, self.plan = explore(step, self.memory, self.plan)
        return outcome


def turned(explorer, robot, steps, *, memory=None, **options):
    """Actions on a map that never changes; the robot only turns. And its pose, and all visits."""
    phase = Exploration(explorer, memory=memory, **options)
    phase.plan = phase.plan.explore(destination=explorer.next_destination(None))
    done = []
    for _ in range(steps):
        outcome = phase.act(robot, corridor())
        if outcome is Phase.END:
            break
        assert isinstance(outcome, Decision)
        done.append(outcome.action)
        turn = {Action.TURN_LEFT: 1, Action.TURN_RIGHT: -1}[certain(outcome.action)]
        robot = Pose2(robot.x, robot.y, robot.yaw + turn * math.radians(30.0))
    return done, robot, phase.memory.search.visits


@pytest.mark.parametrize("yaw", [0.0, math.pi, -1.0])
def test_who_comes_to_a_door_looks_through_it_before_leaving(yaw):
    done, robot, visits = turned(Once((4.0, 2.2)), Pose2(4.0, 2.0, yaw), 20)
    assert 1 <= len(done) <= 6
    assert abs(robot.bearing_to(*DOOR)) <= math.radians(15.0) + 1e-6
    assert visits == [(4.0, 2.2)]


def test_who_comes_to_where_the_floor_ends_looks_there_once():
    done, robot, visits = turned(Once((4.0, 2.2), -math.pi / 2.0), Pose2(4.0, 2.0, 0.0), 20)
    assert done == 3 * [Action.TURN_RIGHT]
    assert robot.yaw == pytest.approx(-math.pi / 2.0)
    assert visits == [(4.0, 2.2)]


def test_the_paper_leaves_at_once():
    done, _, _ = turned(Once((4.0, 2.2)), Pose2(4.0, 2.0, math.pi), 20, look_across_boundary=False)
    assert done == []


def test_where_nothing_is_unexplored_nothing_is_looked_at():
    done, _, _ = turned(Once((1.0, 1.5)), Pose2(1.0, 1.4, 2.0), 20)
    assert done == []


class Wavers:
    """An explorer that names one destination after the other."""

    def __init__(self, *positions, answers_at_once=True):
        self._left = [
            Destination(*position, reason=f"answer {number}")
            for number, position in enumerate(positions, 1)
        ]
        self.answers_at_once = answers_at_once

    def next_destination(self, view):
        return self._left.pop(0) if self._left else None


LEFT_END, RIGHT_END = (0.5, 1.5), (7.5, 1.5)


def destinations(explorer, steps, **options):
    """Destinations after each step, the events and the visits, of a robot that stands still."""
    phase = Exploration(explorer, drop_explored=False, **options)
    found = []
    for _ in range(steps):
        phase.act(Pose2(4.0, 1.5, math.pi / 2), corridor())
        found.append(certain(phase.plan.destination).xy)
    return found, phase.events, phase.memory.search.visits


def test_what_has_become_better_on_the_way_is_gone_to():
    explorer = Wavers(LEFT_END, RIGHT_END)
    found, events, visits = destinations(explorer, 7, reconsider_steps=3)
    assert found == [LEFT_END] * 3 + [RIGHT_END] * 4
    assert events == ["destination changed"]
    assert visits == []  # the first was neither reached nor given up


def test_nobody_wavers_between_two_destinations():
    explorer = Wavers(*[LEFT_END, RIGHT_END] * 5)
    found, events, _ = destinations(explorer, 12, reconsider_steps=2)
    assert found == [LEFT_END] * 2 + [RIGHT_END] * 10
    assert events == ["destination changed"]


def test_a_destination_beside_the_present_one_is_no_other():
    beside = (LEFT_END[0] + 0.4, LEFT_END[1])
    found, events, _ = destinations(Wavers(LEFT_END, beside), 5, reconsider_steps=3)
    assert found == [LEFT_END] * 5
    assert events == []


def test_the_reason_for_a_destination_is_that_of_the_latest_answer():
    phase = Exploration(Wavers(LEFT_END, LEFT_END), drop_explored=False, reconsider_steps=2)
    reasons = []
    for _ in range(4):
        decision = phase.act(Pose2(4.0, 1.5, math.pi / 2), corridor())
        assert isinstance(decision, Decision)
        reasons.append(decision.reason)
    assert reasons == ["answer 1"] * 2 + ["answer 2"] * 2


@pytest.mark.parametrize(
    ("answers_at_once", "reconsider_steps"), [(False, 3), (True, None)], ids=["slow", "paper"]
)
def test_who_answers_slowly_is_asked_once_and_so_is_everybody_in_the_paper(
    answers_at_once, reconsider_steps
):
    explorer = Wavers(LEFT_END, RIGHT_END, answers_at_once=answers_at_once)
    found, _, _ = destinations(explorer, 9, reconsider_steps=reconsider_steps)
    assert found == [LEFT_END] * 9


def test_the_boundary_is_free_floor_beside_the_unknown():
    points = unexplored_boundary(corridor(), (4.0, 2.2), 0.75)
    assert len(points) > 0
    assert np.abs(points[:, 0] - 4.0).max() < 0.6
    assert np.allclose(points[:, 1], points[0, 1])
    assert len(unexplored_boundary(corridor(), (1.0, 1.5), 0.75)) == 0


@pytest.mark.parametrize("middle", [(0, 0), (4, 11), (7, 3), (11, 15), (-2, 18)])
def test_the_boundary_around_a_position_is_all_of_it_in_a_square(middle):
    cells = np.random.default_rng(0).choice([0, 1, 2], (12, 16)).astype(np.uint8)
    grid = OccupancyGrid(cells, 0.05, (0.3, -0.4))
    rows, columns = (slice(max(at - 3, 0), max(at + 4, 0)) for at in middle)
    expected = set[tuple[int, int]]()
    for i, j in np.ndindex(cells.shape):
        around = cells[rows, columns][max(i - 1 - rows.start, 0) : max(i + 2 - rows.start, 0)]
        around = around[:, max(j - 1 - columns.start, 0) : max(j + 2 - columns.start, 0)]
        is_around = rows.start <= i < rows.stop and columns.start <= j < columns.stop
        if is_around and cells[i, j] == Cell.FREE and (around == Cell.UNKNOWN).any():
            expected.add((i, j))
    found = grid.cells_of(unexplored_boundary(grid, grid.centre_of(*middle), 0.15))
    assert set(map(tuple, found.tolist())) == expected


def test_a_turn_towards_what_is_ahead_is_none():
    robot = Pose2(0.0, 0.0, 0.0)
    assert turn_towards(robot, (1.0, 0.1), MotionConfig()) is None
    assert turn_towards(robot, (0.0, 1.0), MotionConfig()) is Action.TURN_LEFT
    assert turn_towards(robot, (0.0, -1.0), MotionConfig()) is Action.TURN_RIGHT


def far_beyond_the_door():
    """The memory of a robot that has seen the goal through the door, 7 m away."""
    memory = Memory(MappingConfig(), Embodiment())
    seen = thing_before_wall(thing_m=7.0, wall_m=9.0, robot=Pose2(4.0, 0.5, math.pi / 2))
    perception().look(seen, Goal("bed"), memory.floor)
    return memory


def heading_for(memory, robot):
    """Positions of a robot that explores a map that never changes, until nothing is left."""
    grid = drawn(UNKNOWN_HALL + CORRIDOR, scale=10)
    phase, positions = Exploration(Once((1.0, 1.5)), memory=memory), [robot.xy]
    for _ in range(60):
        outcome = phase.act(robot, grid)
        if outcome is Phase.END:
            break
        assert isinstance(outcome, Decision)
        action = certain(outcome.action)
        if action is Action.MOVE_FORWARD:
            robot = Pose2(
                robot.x + 0.5 * math.cos(robot.yaw), robot.y + 0.5 * math.sin(robot.yaw), robot.yaw
            )
            positions.append(robot.xy)
        else:
            turn = math.radians(30.0 if action is Action.TURN_LEFT else -30.0)
            robot = Pose2(robot.x, robot.y, robot.yaw + turn)
    return positions, phase.events


def test_who_saw_the_goal_far_away_goes_there_through_the_unknown_before_all_else():
    memory = far_beyond_the_door()
    end = certain(memory.search.evidence.far_position)
    positions, events = heading_for(memory, Pose2(4.0, 1.0, -math.pi / 2))
    nearest = min(range(len(positions)), key=lambda i: math.dist(positions[i], end))
    assert math.dist(positions[nearest], end) < 0.6
    driven = sum(math.dist(a, b) for a, b in pairwise(positions[: nearest + 1]))
    assert driven < 1.3 * math.dist(positions[0], end)
    assert events.count("goal seen far away") == 1  # once there, it explores
    assert memory.search.evidence.far_position is None


def test_the_paper_does_not_go_to_what_is_far_away():
    turns, _, visits = turned(
        Once((4.0, 2.2)),
        Pose2(4.0, 2.0, math.pi),
        20,
        memory=far_beyond_the_door(),
        pursue_far_sightings=False,
        look_across_boundary=False,
    )
    assert turns == []
    assert visits == [(4.0, 2.2)]


class Stubborn:
    """An explorer that always names a place to which no path leads."""

    def next_destination(self, view):
        return Destination(100.0, 0.0, reason="there")


def test_a_circle_of_headings_from_which_no_destination_leads_on_ends_exploration():
    phase, robot = Exploration(Stubborn(), drop_explored=False), Pose2(4.0, 2.0, 0.0)
    for _ in range(12):
        assert phase.act(robot, corridor()) is not Phase.END
    phase.plan = phase.plan.explore(destination=Destination(6.0, 2.0, reason="here"))
    assert isinstance(phase.act(robot, corridor()), Decision)  # so that the circle begins anew
    assert phase.plan.exploring.in_vain is None
    phase.plan = phase.plan.explore(destination=None)
    for _ in range(12):
        assert phase.act(robot, corridor()) is not Phase.END
    assert phase.act(robot, corridor()) is Phase.END
    vain = phase.plan.exploring.in_vain
    assert vain is not None
    assert vain.why == "no path to destination at (100.0, 0.0) m: there"


def test_the_circle_begins_anew_where_the_robot_stands_elsewhere():
    phase = Exploration(Stubborn(), drop_explored=False)
    for x in (4.0, 4.5, 5.0):
        for _ in range(8):
            assert phase.act(Pose2(x, 2.0, 0.0), corridor()) is not Phase.END


def test_who_forgets_and_goes_on_asks_from_every_heading_to_the_end():
    phase = Exploration(Stubborn(), end_when_explored=False)
    outcomes = [phase.act(Pose2(4.0, 2.0, 0.0), corridor()) for _ in range(30)]
    assert Phase.END not in outcomes
