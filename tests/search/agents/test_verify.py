"""Laws of the check at the goal area, and of what follows it."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from box_scenes import room_boxes, scene_of
from hypernav.app.build.agents import build_search
from hypernav.core.embodiment import Action
from hypernav.core.episode import Outcome
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.trace import ExchangeLog
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from hypernav.simulator.worlds.simulation import SimulatedWorld
from small_episodes import episode_from
from small_worlds import colourless_world, small_config

GOING_NEARER = "here is the table, going nearer"
SHORT_STEPS = {"motion": {"forward_m": 0.25, "turn_angle_deg": 30.0}}
SCREEN_M = 0.55
TABLE = np.array([[7.0, 1.0], [8.5, 3.0]])


@cache
def meeting_table() -> SimulatedWorld:
    """A table with two chairs before it, which are in its box."""
    boxes = [
        *room_boxes(9.0, 4.0),
        ("table", (7.0, 1.0, 0.0), (8.5, 3.0, 0.75)),
        ("chair", (6.4, 1.0, 0.0), (6.8, 1.3, 0.9)),
        ("chair", (6.4, 2.7, 0.0), (6.8, 3.0, 0.9)),
    ]
    config = small_config(embodiment=SHORT_STEPS)
    return colourless_world(scene_of(*boxes, name="table"), config)


class Boxes(GroundTruthDetector):
    """Sees what is there, and knows no outlines."""

    def detect(self, observation, goal):
        return [replace(one, mask=None) for one in super().detect(observation, goal)]


class SaysYes:
    """A presence check that counts how often it is asked."""

    def __init__(self):
        self.asked = 0

    def is_present(self, observation, goal):
        self.asked += 1
        return True


def search_for_the_table(x, detector, *, presence=None, most=150, **options):
    """Traces, and the robot's distance from the table in the end, metres."""
    options = {"max_steps": most, **options}
    config = small_config(search=options, embodiment=SHORT_STEPS)
    agent = build_search(config, detector, ExchangeLog(), presence=presence)
    start = Pose2(x, 2.0, 0.0)
    episode = EpisodeRun(agent, meeting_table(), episode_from(start, "table", max_steps=most))
    steps = [step.trace for step in episode]
    assert episode.result().outcome is Outcome.FOUND
    robot = np.array(start.xy) + steps[-1].pose[:2]
    return steps, float(np.linalg.norm(robot - robot.clip(*TABLE)))


@pytest.mark.parametrize("x", [2.0, 3.1, 4.4])
def test_it_goes_straight_on_to_a_goal_whose_outline_was_guessed(x):
    steps, gap_m = search_for_the_table(x, Boxes())
    _, without_m = search_for_the_table(x, Boxes(), go_nearer=False)
    nearer = [step for step in steps if step.reason == GOING_NEARER]
    assert {step.action for step in nearer} == {Action.MOVE_FORWARD}
    assert gap_m < without_m
    assert steps[-1].action is Action.STOP


def test_the_last_step_is_a_stop_and_no_step_nearer():
    without, _ = search_for_the_table(2.0, Boxes(), go_nearer=False)
    steps, _ = search_for_the_table(2.0, Boxes(), most=len(without))
    assert len(steps) == len(without)
    assert steps[-1].action is Action.STOP


def test_it_stays_where_it_is_at_a_goal_whose_outline_is_known():
    steps, _ = search_for_the_table(2.0, GroundTruthDetector())
    assert GOING_NEARER not in {step.reason for step in steps}


def test_the_check_is_not_asked_again_on_the_last_steps():
    presence = SaysYes()
    steps, _ = search_for_the_table(2.0, Boxes(), presence=presence)
    assert GOING_NEARER in {step.reason for step in steps}
    assert presence.asked == 1


class SeesNoFartherThanTheScreen(GroundTruthDetector):
    """Sees what is there, but nothing where a screen stands right before the camera."""

    def detect(self, observation, goal):
        is_screened = float(observation.depth.max()) <= SCREEN_M
        return [] if is_screened else super().detect(observation, goal)


@pytest.mark.parametrize("sees_first", [True, False])
def test_it_leaves_a_position_from_which_something_hides_the_goal(sees_first):
    config = small_config(
        search={"see_before_stop": sees_first, "verify_view": "current"}, embodiment=SHORT_STEPS
    )
    presence = SaysYes()
    agent = build_search(config, SeesNoFartherThanTheScreen(), ExchangeLog(), presence=presence)
    world = meeting_table()
    start = Pose2(2.0, 2.0, 0.0)
    episode = episode_from(start, "table", max_steps=150)
    observation = world.reset(episode)
    agent.reset(episode.goal)
    events = []
    while (action := agent.act(observation)) not in (Action.STOP, None):
        events += agent.last_step.events
        observation = world.step(action)
        here = np.array(world.pose.xy)
        if not presence.asked and np.linalg.norm(here - here.clip(*TABLE)) < 1.1:
            depth = np.full_like(observation.depth, SCREEN_M)
            observation = replace(observation, depth=depth)
    assert ("goal area not in sight from here" in events) == sees_first
