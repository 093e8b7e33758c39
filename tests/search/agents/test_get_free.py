"""Laws of a robot that touches what its map does not show."""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from box_scenes import room_boxes, scene_of
from box_views import FLOOR, SolidBox, view_of
from hypernav.app.build.agents import build_search
from hypernav.app.build.components.component_specs import PresetName
from hypernav.app.build.presets import preset
from hypernav.core.embodiment import Action
from hypernav.core.episode import Outcome
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.trace import Ending, ExchangeLog, Mode, ModuleClock
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.search.agents.get_free import closed_turns, get_free, repeats, with_tried
from hypernav.search.agents.plan import Climbing, Plan
from hypernav.search.agents.step import Decision, Step
from hypernav.search.memory.memory import Memory
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from hypernav.simulator.worlds.scenes.scene import Scene
from hypernav.simulator.worlds.simulation import SimulatedWorld
from hypernav.simulator.worlds.surface.walkable import WalkableGrid
from small_episodes import episode_from
from small_worlds import small_config

GETS_FREE = "touching something, trying to get free of it"
IN_POCKET = Pose2(0.6, 4.65, 0.0)
SHARE = 0.6
"""Share of a step below which it was cut short."""


def pocket(unseen_m: float, *, table_top_m: float = 4.3) -> Scene:
    """A room whose only way from a corner to the bed is an aisle between a wall and a table.

    Args:
        unseen_m: Length by which the table reaches into the aisle.
        table_top_m: Greatest y of the table.
    """
    return scene_of(
        *room_boxes(5.0, 5.0),
        ("bed", (3.4, 0.1, 0.0), (4.9, 1.2, 0.5)),
        ("table", (0.6 - unseen_m, 1.5, 0.0), (2.5, table_top_m, 0.7)),
        (None, (2.4, table_top_m - 0.1, 0.0), (2.5, 5.0, 2.5)),
    )


def walled_in(unseen_m: float) -> Scene:
    """The same with a larger corner, which the table closes."""
    return pocket(3.0 * unseen_m, table_top_m=3.3)


def search_for_bed(scene, start, *, preset: PresetName = "default", steps=150):
    """The trace and the result of a search in a scene whose table is larger than it is seen."""
    config = small_config(preset, search={"max_steps": steps})
    walkable = WalkableGrid.from_scene(scene(0.1), config.embodiment.body)
    world = SimulatedWorld(scene(0.0), config.world, config.embodiment, walkable=walkable)
    agent = build_search(config, GroundTruthDetector(), ExchangeLog())
    run = EpisodeRun(agent, world, episode_from(start, "bed", max_steps=steps))
    return [step.trace for step in run], run.result()


def cut_short(steps) -> list[Pose2]:
    """Poses in which the robot stood after a step that was cut short."""
    return [
        Pose2(*after.pose)
        for before, after in pairwise(steps)
        if before.action is Action.MOVE_FORWARD
        and math.dist(before.pose[:2], after.pose[:2]) < SHARE * 0.5
    ]


@pytest.mark.parametrize("turns", [0, 3, 6])
def test_a_robot_gets_out_of_a_pocket_that_its_bumps_closed(turns):
    start = replace(IN_POCKET, yaw=turns * math.pi / 6.0)
    steps, result = search_for_bed(pocket, start)
    assert cut_short(steps)
    assert GETS_FREE in {step.reason for step in steps}
    assert result.outcome is Outcome.FOUND


def test_a_step_that_was_cut_short_is_not_tried_again_from_there():
    steps, _ = search_for_bed(pocket, IN_POCKET)
    bumps = cut_short(steps)
    again = [
        step
        for step in steps
        if step.action is Action.MOVE_FORWARD
        and any(one.distance_to(*step.pose[:2]) < 1e-6 for one in bumps)
        and any(abs(math.remainder(step.pose[2] - one.yaw, math.tau)) < 1e-6 for one in bumps)
    ]
    assert not again


def test_a_robot_that_is_walled_in_gives_up():
    steps, _ = search_for_bed(walled_in, IN_POCKET, steps=400)
    assert cut_short(steps)
    assert steps[-1].ending is Ending.GAVE_UP
    assert len(steps) < 200


@pytest.mark.parametrize("preset", ["paper", "default"])
def test_the_paper_senses_no_bump_and_orders_the_same_step_again(preset):
    config = small_config(preset)
    world = SimulatedWorld(pocket(0.0), config.world, config.embodiment)
    agent = build_search(config, GroundTruthDetector(), ExchangeLog())
    agent.reset(Goal("bed"))
    observation = world.reset(episode_from(IN_POCKET, "bed"))
    while (action := agent.act(observation)) is not Action.MOVE_FORWARD:
        assert action is not None
        observation = world.step(action)
    before = agent.grid.occupied.copy()
    again = [agent.act(observation) for _ in range(3)]  # it is held, and doesn't move
    senses = preset == "default"
    assert (again != [Action.MOVE_FORWARD] * 3) is senses
    assert (agent.grid.occupied & ~before).any() == senses


def headings_tried(
    boxes: Sequence[SolidBox], way: Sequence[Pose2], bumps=(), *, turn_angle_deg: float = 30.0
) -> list[float]:
    """Headings in which a robot steps that came a way and does not move whatever it tries.

    Args:
        boxes: What there is.
        way: Poses from which it has looked; it is at the last one.
        bumps: Positions ``(x, y)`` that are marked as bumps, metres.
        turn_angle_deg: Angle of a turn.
    """
    changes = {"embodiment": {"motion": {"turn_angle_deg": turn_angle_deg}}}
    config = preset("default").with_(**changes)
    camera = config.embodiment.camera.intrinsics
    agent = build_search(config, GroundTruthDetector(), ExchangeLog())
    memory = Memory(config.mapping, config.embodiment)
    frames = [view_of(boxes, pose, camera=camera) for pose in way]
    for frame in frames:
        memory.floor.map.integrate(frame)
    memory.mark_occupied(np.array(bumps).reshape(-1, 2))
    step = Step(0, Goal("bed"), frames[-1], memory.obstacles, agent.components, ModuleClock(), [])
    tried, plan, actions = list[float](), Plan.at_start(config.search, turns=0), 0
    while isinstance(outcome := get_free(step, memory, plan)[0], Decision):
        robot = step.robot
        actions += 1
        assert actions <= 150, "it goes on and on"
        if outcome.action is Action.MOVE_FORWARD:
            tried.append(robot.yaw)
            plan = replace(plan, tried=(*plan.tried, robot))
            continue
        turns = 1 if outcome.action is Action.TURN_LEFT else -1
        turned = robot.yaw + turns * math.radians(step.motion.turn_angle_deg)
        frame = view_of(boxes, Pose2(robot.x, robot.y, turned), camera=camera)
        step = replace(step, observation=frame)
    return tried


def test_a_robot_tries_no_heading_over_a_drop():
    boxes = [
        ((-9.0, -9.0, -0.3), (2.0, 9.0, 0.0)),
        ((2.0, -9.0, -3.0), (9.0, 9.0, -1.8)),
    ]
    tried = headings_tried(boxes, [Pose2(x, 0.0, 0.0) for x in np.arange(-0.2, 1.85, 0.1)])
    assert 3 <= len(tried) < 12
    assert all(math.cos(yaw) < 0.8 for yaw in tried)


def test_a_robot_doubts_its_bumps_and_not_what_images_show():
    wall, way = ((0.2, -5.0, 0.0), (0.4, 5.0, 2.0)), [Pose2(-2.0, 0.0, 0.0), Pose2(0.0, 0.0, 0.0)]
    around = [Pose2(0.0, 0.0, k * math.pi / 6.0).ahead(0.25).xy for k in range(12)]
    everywhere = headings_tried([FLOOR], way, around)
    assert len(everywhere) == 12
    tried = headings_tried([FLOOR, wall], way, around)
    assert len(tried) >= 7
    assert all(math.cos(yaw) < 0.6 for yaw in tried)


@pytest.mark.parametrize("turn_angle_deg", [120.0, 90.0, 72.0, 30.0])
def test_a_robot_tries_all_headings_of_a_circle(turn_angle_deg):
    tried = headings_tried([FLOOR], [Pose2(0.0, 0.0, 0.0)], turn_angle_deg=turn_angle_deg)
    count = round(360.0 / turn_angle_deg)
    assert {round(math.degrees(yaw) / turn_angle_deg) % count for yaw in tried} == {*range(count)}
    assert len(tried) == count


def standing_free(forward_m: float) -> tuple[Step, Plan]:
    """A step in an empty map, of a robot that has just bumped ahead."""
    config = preset("default").with_(embodiment={"motion": {"forward_m": forward_m}})
    agent = build_search(config, GroundTruthDetector(), ExchangeLog())
    frame, here = view_of([FLOOR], Pose2(0.0, 0.0, 0.0)), Pose2(0.0, 0.0, 0.0)
    grid = Memory(config.mapping, config.embodiment).obstacles
    step = Step(0, Goal("bed"), frame, grid, agent.components, ModuleClock(), [])
    ordered = (here, Action.MOVE_FORWARD)
    return step, replace(Plan.at_start(config.search, turns=0), ordered=ordered, is_recovering=True)


@pytest.mark.parametrize("forward_m", [0.04, 0.25])
def test_a_whole_step_ends_getting_free_however_short_steps_are(forward_m):
    step, plan = standing_free(forward_m)
    assert with_tried(step, plan).is_recovering
    moved = replace(step, observation=view_of([FLOOR], Pose2(forward_m, 0.0, 0.0)))
    assert not with_tried(moved, plan).is_recovering


def test_on_stairs_no_other_headings_are_tried():
    step, plan = standing_free(0.25)
    plan = with_tried(step, plan)
    ahead = Decision(Action.MOVE_FORWARD, Mode.EXPLORE, "ahead")
    assert repeats(step, plan, ahead)
    assert not repeats(step, replace(plan, climbing=Climbing(0)), ahead)


def test_a_heading_that_was_tried_is_told_once_by_the_fewest_turns():
    step, plan = standing_free(0.5)
    count = step.motion.turns_of_a_circle
    for k in range(count):
        tried = (Pose2(0.0, 0.0, math.tau * k / count),)
        (turns,) = closed_turns(step, replace(plan, tried=tried))
        assert turns % count == k
        assert abs(turns) <= count / 2
