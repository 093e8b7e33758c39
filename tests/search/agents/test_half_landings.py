"""A robot goes over stairs that turn back on a half landing, whatever heading it begins with."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from box_scenes import Box, scene_of
from hypernav.app.build.agents import build_search
from hypernav.app.build.presets import preset
from hypernav.core.embodiment import Action
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.observation import Observation
from hypernav.core.trace import Mode
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from hypernav.simulator.worlds.simulation import SimulatedWorld
from searches import searched
from small_episodes import episode_from
from stair_views import TREAD_M

CONFIG = preset("default").with_(embodiment={"body": {"max_step_m": 0.2}})
RISERS, RISE_M = 8, 0.175
HALF_M = RISERS * RISE_M
EDGE_X, FAR_X = 4.0, 4.0 + (RISERS - 1) * TREAD_M
"""Where the floors end and the flights begin, and where they come to the half landing, metres."""
END_X, LOW_M = FAR_X + 1.2, -2.0 * HALF_M
GOALS = {"bed": LOW_M, "sofa": 0.0}


@cache
def building(between_m: float) -> SimulatedWorld:
    """A room with a sofa above one with a bed, and stairs with a wall between their flights."""
    wide, back = 1.15, 1.15 + between_m
    side = back + wide
    boxes: list[Box] = [
        (None, (-0.1, -0.1, LOW_M - 0.1), (END_X + 0.1, 4.1, LOW_M)),
        (None, (-0.1, -0.1, -0.2), (EDGE_X, 4.1, 0.0)),
        (None, (-0.1, -0.1, LOW_M), (END_X + 0.1, 0.0, 2.5)),
        (None, (-0.1, 4.0, LOW_M), (END_X + 0.1, 4.1, 2.5)),
        (None, (-0.1, 0.0, LOW_M), (0.0, 4.0, 2.5)),
        (None, (END_X, 0.0, LOW_M), (END_X + 0.1, 4.0, 2.5)),
        (None, (-0.1, -0.1, 2.5), (END_X + 0.1, 4.1, 2.6)),
        (None, (EDGE_X, side, LOW_M), (END_X, 4.0, 2.5)),  # beside the stairs
        (None, (EDGE_X, wide, LOW_M), (FAR_X, back, 1.0)),  # between the flights
        (None, (EDGE_X, wide, -0.2), (EDGE_X + 0.1, side, 1.0)),  # above the lower flight
        (None, (FAR_X, 0.0, LOW_M), (END_X, side, -HALF_M)),
        ("bed", (0.1, 2.4, LOW_M), (2.0, 3.9, LOW_M + 0.5)),
        ("sofa", (0.1, 2.4, 0.0), (2.0, 3.9, 0.5)),
    ]
    for k in range(RISERS - 1):
        upper, lower = -(k + 1) * RISE_M, -HALF_M - (k + 1) * RISE_M
        from_edge, from_landing = EDGE_X + k * TREAD_M, FAR_X - k * TREAD_M
        boxes.append((None, (from_edge, 0.0, LOW_M), (from_edge + TREAD_M, wide, upper)))
        boxes.append((None, (from_landing - TREAD_M, back, LOW_M), (from_landing, side, lower)))
    scene = replace(scene_of(*boxes, name="half landing"), storeys=(LOW_M, 0.0))
    return SimulatedWorld(scene, CONFIG.world, CONFIG.embodiment)


@pytest.mark.slow
@pytest.mark.parametrize("yaw", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("between_m", [0.1, 0.7])
@pytest.mark.parametrize("goal", GOALS)
def test_stairs_that_turn_back_take_few_steps(goal: str, between_m: float, yaw: float):
    start = episode_from(Pose2(2.6, 0.8, yaw), goal, start_z=LOW_M - GOALS[goal])
    agent = build_search(CONFIG, GroundTruthDetector())
    trace = searched(agent, building(between_m), start, most_steps=200)
    assert trace[-1].action is Action.STOP
    assert len(agent.memory.floors) == 2
    assert sum(one.mode is Mode.CLIMB for one in trace) <= 40


@pytest.mark.slow
@pytest.mark.parametrize(
    ("goal", "between_m", "start"),
    [
        ("bed", 0.4, Pose2(1.2, 1.4, 0.3)),
        ("bed", 0.4, Pose2(3.0, 2.2, -1.2)),
        ("bed", 0.1, Pose2(1.2, 1.4, -1.2)),
        ("sofa", 0.4, Pose2(3.0, 2.2, 1.0)),
        ("bed", 0.7, Pose2(3.0, 2.2, 1.0)),  # these two turned to and fro on the landing
        ("bed", 0.7, Pose2(1.2, 1.4, 2.2)),
    ],
)
def test_a_robot_that_comes_onto_the_stairs_askew_gets_over_them(
    goal: str, between_m: float, start: Pose2
):
    episode = episode_from(start, goal, start_z=LOW_M - GOALS[goal])
    agent = build_search(CONFIG, GroundTruthDetector())
    trace = searched(agent, building(between_m), episode, most_steps=200)
    assert trace[-1].action is Action.STOP
    assert len(agent.memory.floors) == 2
    assert sum(one.mode is Mode.CLIMB for one in trace) <= 50


@pytest.mark.slow
@pytest.mark.parametrize(("far_end", "yaw"), [(True, 0.3), (False, 0.0)])
def test_a_half_landing_whose_height_errs_keeps_no_robot(far_end: bool, yaw: float):
    """Either end of it may seem lower than the other, as odometry and meshes tell heights."""
    start = Pose2(2.6, 0.8, yaw)

    def lowered(observation: Observation) -> Observation:
        seen = observation.camera_to_map
        x, y, _ = start.to_transform().apply(np.array([[*observation.robot.xy, 0.0]]))[0]
        errs = x > FAR_X - 0.05 and (x > FAR_X + 0.55 if far_end else y > 0.9)
        lower = seen.translation - np.array([0.0, 0.0, 0.13 * errs])
        return replace(observation, camera_to_map=Transform(seen.rotation, lower))

    agent, episode = build_search(CONFIG, GroundTruthDetector()), episode_from(start, start_z=0.0)
    trace = searched(agent, building(0.1), episode, most_steps=120, sees=lowered)
    assert trace[-1].action is Action.STOP
