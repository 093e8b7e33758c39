"""The state of an episode, in a world that is not the simulator and knows no truth."""

import math

import numpy as np
import pytest

from hypernav.app.build.agents import build_search
from hypernav.core.embodiment import Action, CameraConfig, Embodiment, MotionConfig
from hypernav.core.errors import ConfigError, WorldError
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.trace import Ending, ExchangeLog
from hypernav.core.world import SceneTruth, World
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.lab.episodes.trial import Trial
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from hypernav.simulator.worlds.box_room import DOOR, BoxRoom
from small_episodes import episode_from
from small_worlds import small_config, two_rooms

START = Pose2(0.0, 0.0, 0.0)


class BareRoom:
    """A world with the least that the contract asks for: like a robot's, it knows no truth."""

    truth: SceneTruth | None = None
    collided = False

    def __init__(self, embodiment=None):
        self.embodiment = embodiment or small_config().embodiment
        self.is_over = True

    def reset(self, episode, rng=None):
        self._room = BoxRoom(embodiment=self.embodiment)
        self.is_over = False
        return self._room.observe()

    def step(self, action):
        self.is_over = action is Action.STOP
        if not self.is_over:
            self._room.step(action)
        return self._room.observe()


def search(**sections):
    return build_search(small_config(**sections), GroundTruthDetector(), ExchangeLog())


def test_it_keeps_the_contract_of_a_world():
    assert isinstance(BareRoom(), World)
    assert isinstance(two_rooms(), World)
    assert two_rooms().truth is not None


@pytest.mark.parametrize(
    ("action", "ending"),
    [(Action.STOP, Ending.FOUND), (None, Ending.GAVE_UP), (Action.TURN_LEFT, None)],
)
def test_only_stop_claims_that_the_goal_is_here(action, ending):
    trial = Trial(BareRoom(), episode_from(START, DOOR))
    trial.take(action)
    assert trial.ending is ending
    assert trial.is_over == (ending is not None)
    assert trial.steps == 1


def test_after_the_end_nothing_more_is_done():
    trial = Trial(BareRoom(), episode_from(START, DOOR, max_steps=1))
    trial.take(Action.TURN_LEFT)
    assert trial.is_over
    assert trial.ending is None
    with pytest.raises(WorldError, match="the episode is over"):
        trial.take(Action.TURN_LEFT)


def test_giving_up_moves_no_robot():
    world = BareRoom()
    trial = Trial(world, episode_from(START, DOOR))
    before = trial.observation
    assert trial.take(None) is before
    assert not world.is_over


def test_without_truth_a_search_runs_and_cannot_be_measured():
    run = EpisodeRun(search(), BareRoom(), episode_from(START, DOOR, max_steps=60))
    steps = list(run)
    assert run.trial.ending is Ending.FOUND
    assert steps[-1].trace.action is Action.STOP
    with pytest.raises(WorldError, match="no ground truth about its scene"):
        run.result()


@pytest.mark.parametrize(
    ("embodiment", "words"),
    [
        (Embodiment(motion=MotionConfig(forward_m=0.25)), "motion.forward_m 0.5 instead of 0.25"),
        (
            Embodiment(camera=CameraConfig(height_m=1.31)),
            "camera.width 160 instead of 640, .*camera.height_m 0.88 instead of 1.31",
        ),
    ],
)
def test_an_agent_that_was_built_for_another_robot_is_refused(embodiment, words):
    with pytest.raises(ConfigError, match=words):
        EpisodeRun(search(), BareRoom(embodiment), episode_from(START, DOOR))


def test_an_agent_that_says_nothing_about_its_robot_drives_any():
    class Turner:
        def reset(self, goal):
            pass

        def act(self, observation):
            return Action.TURN_LEFT

    world = BareRoom(Embodiment(motion=MotionConfig(turn_angle_deg=90.0)))
    run = EpisodeRun(Turner(), world, episode_from(START, DOOR, max_steps=3))
    yaws = [step.observation.robot.yaw for step in run]
    assert np.allclose(np.cos(yaws), np.cos([0.0, math.pi / 2, math.pi]), atol=1e-9)
