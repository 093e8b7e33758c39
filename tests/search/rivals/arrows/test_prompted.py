"""Agents that make one long move after the other, with their own stop."""

import math
from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import hypernav
from hypernav.app.build.agents import build_agent
from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.native import native_config
from hypernav.core.embodiment import Action, Embodiment, MotionConfig
from hypernav.core.exploring.exploration import Destination
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.trace import Ending, ExchangeLog, without_timings
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.rivals.arrows.prompted import PromptedAgent, actions_to, paper_actions
from hypernav.search.rivals.config import PromptedConfig
from hypernav.simulator.worlds.box_room import BoxRoom
from hypernav.simulator.worlds.simulation import SimulatedWorld
from small_episodes import episode_from
from small_worlds import small_config, two_rooms

FINE = MotionConfig(forward_m=0.17, turn_angle_deg=5.0)
START = Pose2(2.5, 1.0, math.pi / 2)


class Ahead:
    """Chooses a move of 1 m ahead every time."""

    def __init__(self):
        self.asked = 0
        self.said_to_be_here = []

    def next_destination(self, view):
        self.asked += 1
        self.said_to_be_here.append(view.may_be_here)
        robot = view.robot
        x, y = robot.x + math.cos(robot.yaw), robot.y + math.sin(robot.yaw)
        return Destination(x, y, reason="ahead")


class Says:
    def __init__(self, *answers):
        self.answers = list(answers)

    def is_here(self, observation, goal):
        return self.answers.pop(0) if self.answers else False


def agent_of(explorer, stop, **config) -> PromptedAgent:
    robot = Embodiment(motion=MotionConfig(forward_m=0.5, turn_angle_deg=30.0))
    settings = PromptedConfig(**config)
    log = ExchangeLog()
    return PromptedAgent(explorer, stop, robot, MappingConfig(), log, settings)


def acted(agent: PromptedAgent, most: int = 100) -> list[Action | None]:
    room, actions = BoxRoom(embodiment=agent.embodiment), list[Action | None]()
    agent.reset(Goal("bed"))
    for _ in range(most):
        action = agent.act(room.observe())
        actions.append(action)
        if action is None or action is Action.STOP:
            break
        room.step(action)
    return actions


@pytest.mark.parametrize(
    ("answers", "moves"),
    [([True, True], 1), ([False, True, True], 2), ([True, False, True, True], 3)],
)
def test_only_two_yes_in_a_row_stop(answers, moves):
    explorer = Ahead()
    assert acted(agent_of(explorer, Says(*answers)))[-1] is Action.STOP
    assert explorer.asked == moves


def test_a_right_angle_and_a_metre_and_a_half_are_three_and_three_actions():
    assert paper_actions(Destination(0.0, 1.5, "left"), Pose2(0.0, 0.0, 0.0)) == 6


def test_turning_around_is_six_actions_and_moves_nothing():
    robot = Pose2(1.0, 2.0, 0.5)
    around = Destination(1.0, 2.0, "around", face=0.5 + math.pi)
    assert paper_actions(around, robot) == 6
    assert Counter(actions_to(around, robot, FINE)).keys() <= {
        Action.TURN_LEFT,
        Action.TURN_RIGHT,
    }
    assert len(actions_to(around, robot, FINE)) == 36


@given(heading=st.floats(-math.pi, math.pi), length_m=st.floats(0.2, 1.7), yaw=st.floats(-3.0, 3.0))
def test_a_move_ends_within_half_an_action_of_where_it_was_drawn(heading, length_m, yaw):
    robot = Pose2(0.3, -0.4, yaw)
    angle = yaw + heading
    end = Destination(0.3 + length_m * math.cos(angle), -0.4 + length_m * math.sin(angle), "move")
    actions = Counter(actions_to(end, robot, FINE))
    turned = math.radians(5.0) * (actions[Action.TURN_LEFT] - actions[Action.TURN_RIGHT])
    off = math.remainder(turned - heading, math.tau)
    assert abs(off) <= math.radians(2.5) + 1e-6
    assert abs(0.17 * actions[Action.MOVE_FORWARD] - length_m) <= 0.085 + 1e-6


def test_the_model_is_asked_between_moves_only_and_two_yes_stop():
    explorer = Ahead()
    agent = agent_of(explorer, Says(False, True, True))
    assert acted(agent) == [Action.MOVE_FORWARD] * 4 + [Action.STOP]
    assert explorer.asked == 2
    assert explorer.said_to_be_here == [False, True]
    assert agent.last_step.ending is Ending.FOUND


def test_the_search_is_given_up_after_its_moves():
    agent = agent_of(Ahead(), Says(), most_moves=3)
    assert acted(agent) == [Action.MOVE_FORWARD] * 6 + [None]
    assert agent.take_report() == {"moves": 3, "actions_of_half_a_metre": 6}
    assert agent.take_report() == {"moves": 0, "actions_of_half_a_metre": 0}


def test_a_report_gives_no_budget_back():
    agent = agent_of(Ahead(), Says(), most_moves=1)
    room = BoxRoom(embodiment=agent.embodiment)
    agent.reset(Goal("bed"))
    actions = []
    for _ in range(3):
        actions.append(agent.act(room.observe()))
        agent.take_report()
    assert actions == [Action.MOVE_FORWARD, Action.MOVE_FORWARD, None]


def test_the_search_is_given_up_when_its_actions_are_spent():
    agent = agent_of(Ahead(), Says(), most_actions=3)
    assert acted(agent) == [Action.MOVE_FORWARD] * 4 + [None]


def native_world(agent: str):
    config = native_config(agent, small_config())
    camera = config.embodiment.camera.model_copy(update={"width": 160, "height": 90})
    robot = config.embodiment.model_copy(update={"camera": camera})
    config = config.model_copy(update={"embodiment": robot})
    return config, SimulatedWorld(two_rooms().scene, config.world, config.embodiment)


def searched(agent: str):
    config, world = native_world(agent)
    parts = build_agent(config, ComponentSpecs(agent=agent, native=True))
    rng = np.random.default_rng(0)
    episode = episode_from(START, "bed", max_steps=400)
    run = EpisodeRun(parts.agent, world, episode, rng=rng, told=parts.truth)
    steps = [step.trace.model_dump(mode="json") for step in run if step.trace is not None]
    return [without_timings(step) for step in steps], parts


@pytest.mark.parametrize("agent", ["vlmnav", "pivot"])
def test_native_methods_keep_the_contract(agent):
    config, _ = native_world(agent)
    hypernav.check_agent(build_agent(config, ComponentSpecs(agent=agent, native=True)).agent)


@pytest.mark.parametrize(
    "agent", [pytest.param("vlmnav", marks=pytest.mark.slow), "pivot", "vlfm", "navvlm"]
)
def test_equal_native_searches_are_equal(agent):
    steps, _ = searched(agent)
    assert len(steps) > 10
    assert {step["step"] for step in steps} == set(range(len(steps)))
    assert searched(agent)[0] == steps


def test_who_stops_by_the_truth_says_so():
    _, parts = searched("vlmnav")
    assert any("stops by the truth" in warning for warning in parts.warnings)


def test_vlfm_finishes_its_first_turn_even_where_the_goal_shows():
    config, world = native_world("vlfm")
    parts = build_agent(config, ComponentSpecs(agent="vlfm", native=True))
    start = Pose2(6.0, 1.0, 0.0)  # looks at the bed
    run = EpisodeRun(
        parts.agent,
        world,
        episode_from(start, "bed", max_steps=20),
        rng=np.random.default_rng(0),
        told=parts.truth,
    )
    actions = [step.trace.action for step in run]
    assert actions[:12] == [Action.TURN_LEFT] * 12
