"""A robot that sees no way on over stairs looks around once, and then gives them up."""

import math
from dataclasses import replace

import pytest

from box_views import FLOOR, SolidBox, view_of
from hypernav.app.build.agents import build_search
from hypernav.app.build.presets import preset
from hypernav.core.embodiment import Action
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog, ModuleClock
from hypernav.search.agents.climb import _around, _is_lost, _where_to, climb
from hypernav.search.agents.plan import Climbing, Plan
from hypernav.search.agents.step import Decision, Step
from hypernav.search.mapping.stairs.connectors import Connector
from hypernav.search.memory.memory import Memory
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector

CONFIG = preset("default").with_(embodiment={"body": {"max_step_m": 0.2}})
TURN_RAD = math.radians(CONFIG.embodiment.motion.turn_angle_deg)
COMPONENTS = build_search(CONFIG, GroundTruthDetector(), ExchangeLog()).components
CIRCLE = CONFIG.embodiment.motion.turns_of_a_circle


def step_at(memory: Memory, boxes: list[SolidBox], robot: Pose2, z: float) -> Step:
    """The next step of a robot, which is so high, metres; its memory follows it."""
    camera, height_m = CONFIG.embodiment.camera.intrinsics, CONFIG.embodiment.camera.height_m
    frame = view_of(boxes, robot, camera=camera, height_m=height_m + z)
    floor = memory.follow(frame)
    if not memory.on_stairs:
        floor.map.integrate(frame)
    return Step(0, Goal("bed"), frame, memory.obstacles, COMPONENTS, ModuleClock(), [])


def turns_until_given_up(
    boxes: list[SolidBox], heights_m: list[float], stairs: Connector
) -> tuple[list[Action], list[str]]:
    """The turns of a robot on its way over stairs, and what happened as it made no more of them.

    Args:
        boxes: What there is.
        heights_m: Heights of the robot in its first steps; it stays at the last one.
        stairs: The stairs that it means to take.
    """
    memory = Memory(CONFIG.mapping, CONFIG.embodiment)
    memory.begin_search(sees_stairs=True)
    memory.connectors = (stairs,)
    plan = replace(Plan.at_start(CONFIG.search, turns=0), climbing=Climbing(0))
    turns, yaw = list[Action](), 0.0
    *_, step = (step_at(memory, boxes, Pose2(0.0, 0.0, yaw), z) for z in heights_m)
    while True:
        outcome, plan = climb(step, memory, plan)
        if step.events or not isinstance(outcome, Decision):
            return turns, step.events
        assert outcome.action is not None
        turns.append(outcome.action)
        assert len(turns) <= 2 * CIRCLE, "it turns on and on"
        yaw += TURN_RAD if outcome.action is Action.TURN_LEFT else -TURN_RAD
        step = step_at(memory, boxes, Pose2(0.0, 0.0, yaw), heights_m[-1])


@pytest.mark.parametrize("bearing", [2, 0, -2])
def test_a_robot_that_sees_no_stairs_where_they_should_be_turns_to_them_and_no_farther(bearing):
    x, y = Pose2(0.0, 0.0, bearing * TURN_RAD).ahead(3.0).xy
    stairs = Connector(0, True, (x, y), bearing * TURN_RAD)
    turns, events = turns_until_given_up([FLOOR], [0.0], stairs)
    assert turns == [Action.TURN_LEFT if bearing > 0 else Action.TURN_RIGHT] * abs(bearing)
    assert events == ["stairs given up"]


def test_on_a_landing_without_a_way_on_a_robot_looks_around_once():
    landing: SolidBox = ((-0.4, -0.4, -3.0), (0.4, 0.4, 0.6))
    stairs = Connector(0, True, (-1.0, 0.0), 0.0)
    turns, events = turns_until_given_up([landing], [0.0, 0.3, 0.6], stairs)
    assert turns == [Action.TURN_LEFT] * CIRCLE
    assert events == ["turning back on the stairs"]


@pytest.mark.parametrize(
    ("heights_m", "touching", "goes_by_own"),
    [
        ((0.0, 0.3, 0.7), False, True),
        ((0.0, 0.3, 0.7), True, False),
        ((0.0, 0.7, 0.7), False, False),
    ],
)
def test_only_a_free_step_up_or_down_is_on_stairs(
    heights_m: tuple[float, ...], touching: bool, goes_by_own: bool
):
    """Elsewhere the robot goes by how high the ground looks, 0.6 m: its own height errs."""
    landing: SolidBox = ((-3.0, -3.0, -3.0), (3.0, 3.0, 0.6))
    memory = Memory(CONFIG.mapping, CONFIG.embodiment)
    memory.begin_search(sees_stairs=True)
    walk = [(Pose2(0.3 * k, 0.0, 0.0), z) for k, z in enumerate(heights_m)]
    *_, step = (step_at(memory, [landing], robot, z) for robot, z in walk)
    stairs = _around(step, memory, Climbing(0, touching=touching), goes_up=True)
    assert stairs.on_slope is goes_by_own
    assert stairs.z == pytest.approx(0.7 if goes_by_own else 0.6, abs=0.03)


@pytest.mark.parametrize(
    ("came_by", "is_lost"),
    [
        ((0.0, 0.0, 0.3), True),
        ((0.2, 0.0, 0.5), True),
        ((0.3, 0.0, 0.3), False),
        ((0.0, 0.0, -0.3), False),
        ((0.0, 0.0, 0.9), False),
    ],
)
def test_a_robot_is_lost_within_half_a_step_of_where_it_was_on_the_same_flight(came_by, is_lost):
    memory = Memory(CONFIG.mapping, CONFIG.embodiment)
    memory.begin_search(sees_stairs=True)
    *_, step = (step_at(memory, [FLOOR], Pose2(0.0, 0.0, 0.0), z) for z in (0.0, 0.3))
    assert _is_lost(step, memory, Climbing(0, came_by=(came_by,))) is is_lost


def test_people_read_floors_counted_from_one():
    memory = Memory(CONFIG.mapping, CONFIG.embodiment)
    memory.connectors = (Connector(0, True, (0.0, 0.0), 0.0, other_floor=1),)
    assert _where_to(memory, Climbing(0), goes_up=True) == "to floor 2"
    assert _where_to(memory, Climbing(0, is_back=True), goes_up=False) == "back to floor 1"
