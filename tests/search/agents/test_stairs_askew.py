"""A robot goes down stairs that are parallel to no wall of the room around their head."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from box_scenes import Box, scene_of
from hypernav.app.build.agents import build_search
from hypernav.app.build.presets import preset
from hypernav.core.embodiment import Action
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.trace import Mode
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from hypernav.simulator.worlds.simulation import SimulatedWorld
from searches import searched
from small_episodes import episode_from
from small_worlds import colourless_world
from stair_views import FIRST_X, RISE_M, SIDES_Y, STEPS, TREAD_M

CONFIG = preset("default").with_(embodiment={"body": {"max_step_m": 0.2}})
LOW_M, FOOT_X = -STEPS * RISE_M, FIRST_X + (STEPS - 1) * TREAD_M
MIDDLE_Y = sum(SIDES_Y) / 2.0


@cache
def building() -> SimulatedWorld:
    """Stairs in a floor, between railings; 1 m beside their head passes a wall, turned by 30°."""
    right, left = SIDES_Y
    steps: list[Box] = [
        (
            None,
            (FIRST_X + k * TREAD_M, right, LOW_M),
            (FIRST_X + (k + 1) * TREAD_M, left, -(k + 1) * RISE_M),
        )
        for k in range(STEPS - 1)
    ]
    scene = scene_of(
        (None, (-0.1, -2.1, LOW_M - 0.1), (12.1, 6.1, LOW_M)),
        (None, (-0.1, -2.1, LOW_M), (12.1, -2.0, 2.5)),
        (None, (-0.1, 6.0, LOW_M), (12.1, 6.1, 2.5)),
        (None, (-0.1, -2.1, LOW_M), (0.0, 6.1, 2.5)),
        (None, (12.0, -2.1, LOW_M), (12.1, 6.1, 2.5)),
        (None, (-0.1, -2.1, 2.5), (12.1, 6.1, 2.6)),
        (None, (0.0, -2.0, LOW_M), (FIRST_X, 6.0, 0.0)),
        (None, (FIRST_X, -2.0, LOW_M), (FOOT_X, right, 0.0)),
        (None, (FIRST_X, left, LOW_M), (FOOT_X, 6.0, 0.0)),
        (None, (FIRST_X, right - 0.05, 0.0), (FOOT_X, right, 0.9)),
        (None, (FIRST_X, left, 0.0), (FOOT_X, left + 0.05, 0.9)),
        (None, (FOOT_X, -2.0, LOW_M), (FOOT_X + 0.1, right, 2.5)),
        (None, (FOOT_X, left, LOW_M), (FOOT_X + 0.1, 6.0, 2.5)),
        (None, (FOOT_X, right, 0.3), (FOOT_X + 0.1, left, 2.5)),
        ("bed", (9.9, -1.9, LOW_M), (11.9, -0.4, LOW_M + 0.5)),
        *steps,
        (None, (FIRST_X - 2.6, MIDDLE_Y + 1.0, 0.0), (FIRST_X + 3.0, MIDDLE_Y + 1.1, 2.5)),
        name="askew",
    )
    vertices, head = scene.vertices.copy(), np.array([FIRST_X, MIDDLE_Y])
    cos, sin = math.cos(math.radians(30.0)), math.sin(math.radians(30.0))
    wall = vertices[-8:, :2]
    wall[:] = (wall - head) @ np.array([[cos, sin], [-sin, cos]]) + head
    return colourless_world(replace(scene, vertices=vertices, storeys=(LOW_M, 0.0)), CONFIG)


@pytest.mark.slow
@pytest.mark.parametrize(
    "start", [Pose2(2.6, 2.0, 0.0), Pose2(2.6, 2.0, 0.4), Pose2(3.2, 1.5, -0.4)]
)
def test_stairs_askew_to_a_wall_are_taken_at_once(start: Pose2):
    agent = build_search(CONFIG, GroundTruthDetector())
    trace = searched(agent, building(), episode_from(start, start_z=0.0), most_steps=200)
    assert trace[-1].action is Action.STOP
    assert len(agent.memory.floors) == 2
    assert sum(one.mode is Mode.CLIMB for one in trace) <= 50
