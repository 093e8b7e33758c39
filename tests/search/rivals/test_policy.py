"""What agents of trained policies refuse, and what they tell a policy; without torch."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.core.embodiment import Action, CameraConfig, Embodiment, MotionConfig
from hypernav.core.errors import ConfigError, GoalError
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.lab.evaluation.checks.contracts import check_agent
from hypernav.search.models.policy_network import PIRLNAV, ZSON
from hypernav.search.rivals.config import PolicyConfig
from hypernav.search.rivals.policy import (
    HM3D_CAMERA,
    SQUARE_CAMERA,
    PirlnavAgent,
    PolicyAgent,
    check_robot,
    pose_input,
)
from hypernav.simulator.worlds.box_room import BoxRoom

CAMERA = {"width": 640, "height": 480, "hfov_deg": 79.0, "height_m": 0.88, "pitch_deg": 0.0}
SQUARE = {"width": 128, "height": 128, "hfov_deg": 90.0, "height_m": 1.25, "pitch_deg": 0.0}
TRAINED = Embodiment(motion=MotionConfig(forward_m=0.25))
angles = st.floats(-math.pi, math.pi)
metres = st.floats(-50.0, 50.0)


class Favourite:
    """A network that scores one action best and counts its steps in its state."""

    architecture = PIRLNAV

    def __init__(self, action: int, score: float = 50.0):
        self.logits = np.zeros(6, np.float32)
        self.logits[action] = score
        self.told: list[dict] = []

    def first_state(self):
        return 0

    def step(self, rgb, state, **told):
        self.told.append(told | {"state": state})
        return self.logits, state + 1


class Numbered(PolicyAgent):
    def goal_input(self, goal):
        return 3


def agent_of(network, **config) -> PolicyAgent:
    return Numbered(network, TRAINED, (CAMERA,), PolicyConfig(**config))


@pytest.mark.parametrize(("architecture", "millions"), [(PIRLNAV, 49.0), (ZSON, 14.1)])
def test_networks_have_the_published_size(architecture, millions):
    size = sum(math.prod(shape) for shape in architecture.shapes().values())
    assert round(size / 1e6, 1) == millions


def test_the_robot_of_the_training_is_taken():
    assert HM3D_CAMERA == CAMERA
    check_robot("pirlnav", TRAINED, (HM3D_CAMERA,))
    square = Embodiment(camera=CameraConfig(**SQUARE), motion=MotionConfig(forward_m=0.25))
    check_robot("zson", square, (HM3D_CAMERA, SQUARE_CAMERA))


@pytest.mark.parametrize(
    ("robot", "reason"),
    [
        (Embodiment(), r"forward_m is 0.5 instead of 0.25"),
        (Embodiment(motion=MotionConfig(forward_m=0.25, turn_angle_deg=15.0)), "turn_angle_deg"),
        (
            Embodiment(camera=CameraConfig(hfov_deg=90.0), motion=MotionConfig(forward_m=0.25)),
            "hfov_deg is 90 instead of 79",
        ),
        (
            Embodiment(camera=CameraConfig(pitch_deg=20.0), motion=MotionConfig(forward_m=0.25)),
            "pitch_deg is 20 instead of 0",
        ),
    ],
)
def test_another_robot_is_refused_with_the_reason(robot, reason):
    with pytest.raises(ConfigError, match=reason):
        PirlnavAgent("no-such-file.safetensors", robot)


def test_pose_is_told_as_habitat_does():
    start = Pose2(0.0, 0.0, 0.0)
    assert pose_input(Pose2(2.0, 1.0, 0.5), start) == pytest.approx((2.0, -1.0, 0.5))


@given(x=metres, y=metres, yaw=angles, ahead=metres, left=metres, turn=st.floats(-3.0, 3.0))
def test_a_pose_is_told_from_the_start_wherever_that_is(x, y, yaw, ahead, left, turn):
    cos, sin = math.cos(yaw), math.sin(yaw)
    robot = Pose2(x + ahead * cos - left * sin, y + ahead * sin + left * cos, yaw + turn)
    assert pose_input(robot, Pose2(x, y, yaw)) == pytest.approx((ahead, -left, turn), abs=1e-6)


def test_the_last_action_and_the_state_go_into_the_next_step_and_reset_forgets_both():
    network = Favourite(Action.TURN_LEFT)
    agent, room = agent_of(network), BoxRoom(embodiment=TRAINED)
    for _ in range(2):
        agent.reset(Goal("toilet"))
        assert [agent.act(room.observe()) for _ in range(3)] == [Action.TURN_LEFT] * 3
    assert [told["last_action"] for told in network.told] == [0, 3, 3, 0, 3, 3]
    assert [told["state"] for told in network.told] == [0, 1, 2, 0, 1, 2]
    assert {told["goal"] for told in network.told} == {3}


@pytest.mark.slow
@pytest.mark.parametrize("choice", ["sample", "mode"])
def test_looking_up_and_down_is_never_chosen(choice):
    agent, room = agent_of(Favourite(5), choice=choice), BoxRoom(embodiment=TRAINED)
    agent.reset(Goal("bed"))
    assert {agent.act(room.observe()) for _ in range(50)} <= set(Action)


@pytest.mark.slow
def test_samples_follow_the_scores_and_the_mode_does_not_vary():
    network, room = Favourite(Action.MOVE_FORWARD, score=0.5), BoxRoom(embodiment=TRAINED)
    drawn = agent_of(network)
    drawn.reset(Goal("bed"))
    assert {drawn.act(room.observe()) for _ in range(60)} == set(Action)
    likeliest = agent_of(network, choice="mode")
    likeliest.reset(Goal("bed"))
    assert {likeliest.act(room.observe()) for _ in range(20)} == {Action.MOVE_FORWARD}


def test_the_contract_of_agents_is_kept():
    check_agent(agent_of(Favourite(Action.TURN_RIGHT, score=1.0)))


@pytest.mark.parametrize(
    ("goal", "number"),
    [("chair", 0), ("bed", 1), ("plant", 2), ("toilet", 3), ("television", 4), ("couch", 5)],
)
def test_goals_have_the_numbers_of_the_challenge(goal, number):
    assert PirlnavAgent.goal_input(None, Goal(goal)) == number  # pyright: ignore[reportArgumentType]


def test_other_goals_are_refused():
    with pytest.raises(GoalError, match="trained for chair, bed"):
        PirlnavAgent.goal_input(None, Goal("umbrella"))  # pyright: ignore[reportArgumentType]
