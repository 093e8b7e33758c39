"""A goal that is seen on another floor is gone to there, and not to what lies above or below it."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import pytest

from box_scenes import Box, scene_of
from box_views import FLOOR, view_of
from hypernav.app.build.agents import build_search
from hypernav.app.build.presets import preset
from hypernav.core.embodiment import Action
from hypernav.core.geometry.boxes import Box as ImageBox
from hypernav.core.geometry.boxes import Detection
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.trace import StepTrace
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from hypernav.simulator.worlds.simulation import SimulatedWorld
from searches import searched
from small_episodes import episode_from
from stair_views import TREAD_M

CONFIG = preset("default").with_(embodiment={"body": {"max_step_m": 0.2}})
RISERS, RISE_M = 15, 0.175
LOW_M = -RISERS * RISE_M
EDGE_X, FOOT_X, END_X = 4.0, 4.0 + (RISERS - 1) * TREAD_M, 11.0
"""Where the gallery ends and the stairs begin, where they end, and the far wall, metres."""
WIDE_M = 1.2


@cache
def building() -> SimulatedWorld:
    """A hall with a bed, and a gallery with a sofa; each is seen from the other floor.

    Straight stairs lead along a wall from the gallery's end into the hall.
    """
    boxes: list[Box] = [
        (None, (-0.1, -0.1, LOW_M - 0.1), (END_X + 0.1, 5.1, LOW_M)),
        (None, (-0.1, -0.1, -0.2), (EDGE_X, 5.1, 0.0)),
        (None, (-0.1, -0.1, LOW_M), (END_X + 0.1, 0.0, 2.5)),
        (None, (-0.1, 5.0, LOW_M), (END_X + 0.1, 5.1, 2.5)),
        (None, (-0.1, 0.0, LOW_M), (0.0, 5.0, 2.5)),
        (None, (END_X, 0.0, LOW_M), (END_X + 0.1, 5.0, 2.5)),
        (None, (-0.1, -0.1, 2.5), (END_X + 0.1, 5.1, 2.6)),
        (None, (EDGE_X - 0.1, WIDE_M, 0.0), (EDGE_X, 5.0, 0.3)),  # a kerb at the gallery's edge
        ("bed", (5.0, 3.4, LOW_M), (6.9, 4.9, LOW_M + 0.5)),
        ("sofa", (2.2, 3.9, 0.0), (3.8, 4.9, 0.8)),
    ]
    for k in range(RISERS - 1):
        x, top = EDGE_X + k * TREAD_M, -(k + 1) * RISE_M
        boxes.append((None, (x, 0.0, LOW_M), (x + TREAD_M, WIDE_M, top)))
    scene = replace(scene_of(*boxes, name="gallery"), storeys=(LOW_M, 0.0))
    return SimulatedWorld(scene, CONFIG.world, CONFIG.embodiment)


class Shows:
    """Shows the goal in one box of every image."""

    def __init__(self, box: ImageBox):
        self.box = box

    def detect(self, observation, goal):
        mask = self.box.mask(observation.camera.width, observation.camera.height)
        return [Detection(self.box, 0.9, "thing", mask)]


class SeesFromTheGallery(GroundTruthDetector):
    """Shows the goal from the gallery alone: below nothing is found."""

    def detect(self, observation, goal):
        return super().detect(observation, goal) if building().position[2] > -0.5 else []


def events(trace: Sequence[StepTrace]) -> list[str]:
    return [event for step in trace for event in step.events]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("goal", "start", "start_z", "on_z"),
    [
        ("bed", Pose2(2.0, 1.0, 0.0), 0.0, LOW_M),
        ("sofa", Pose2(9.5, 2.5, 3.0), LOW_M, 0.0),
    ],
)
def test_what_is_seen_on_another_floor_is_found_there(
    goal: str, start: Pose2, start_z: float, on_z: float
):
    world = building()
    agent = build_search(CONFIG, GroundTruthDetector())
    trace = searched(agent, world, episode_from(start, goal, start_z=start_z), most_steps=250)
    assert "goal seen on another floor" in events(trace)
    assert trace[-1].action is Action.STOP
    assert world.position[2] == pytest.approx(on_z, abs=0.15)


@pytest.mark.slow
@pytest.mark.parametrize("pursues", [True, False])
def test_for_one_that_is_not_found_there_it_does_not_go_to_and_fro(pursues: bool):
    config = CONFIG.with_(search={"pursue_far_sightings": pursues})
    agent, start = build_search(config, SeesFromTheGallery()), Pose2(2.0, 1.0, 0.0)
    trace = searched(agent, building(), episode_from(start, "bed", start_z=0.0), most_steps=200)
    assert trace[-1].action is not Action.STOP
    assert events(trace).count("goal seen on another floor") == int(pursues)
    assert events(trace).count("another floor reached") <= 3


def test_the_trace_says_what_is_on_another_floor_and_that_it_is_not_after_all():
    """The goal is out of range below, and then it stands before the robot."""
    camera = CONFIG.embodiment.camera.intrinsics
    shown = ImageBox(camera.cx - 12.0, camera.height - 60.0, camera.cx + 12.0, camera.height - 36.0)
    agent = build_search(CONFIG, Shows(shown))
    agent.reset(Goal("thing"))
    robot, reasons = Pose2(0.0, 0.0, 0.0), list[str]()
    for boxes in ([], [FLOOR]):
        agent.act(view_of(boxes, robot, camera=camera))
        reasons += [one.reason for one in agent.last_step.detections]
    assert reasons == ["on another floor", ""]
    assert "goal is on this floor after all" in agent.last_step.events
