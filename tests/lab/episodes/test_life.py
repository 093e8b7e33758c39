"""A life: the robot goes on where it stands, in the map that it has."""

import numpy as np
import pytest

from hypernav.app.build.agents import build_agent
from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.core.components.protocols import Remembers
from hypernav.core.embodiment import Action
from hypernav.core.episode import Outcome
from hypernav.core.errors import WorldError
from hypernav.core.geometry.transforms import Pose2
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.lab.episodes.trial import Trial
from hypernav.search.agents.search import SearchAgent
from small_episodes import episode_from
from small_worlds import colourless_world, small_config, two_rooms

START = Pose2(2.5, 1.0, 0.0)


def remembering() -> Remembers:
    agent = build_agent(small_config(), ComponentSpecs()).agent
    assert isinstance(agent, SearchAgent)
    return agent


def searched(agent, goal, goes_on=False):
    run = EpisodeRun(agent, two_rooms(coloured=False), episode_from(START, goal), goes_on=goes_on)
    for _ in run:
        pass
    return run


def test_the_robot_stays_with_its_map_frame_and_may_go_on_after_stop():
    world = two_rooms(coloured=False)
    world.reset(episode_from(START))
    for action in (Action.MOVE_FORWARD, Action.TURN_LEFT, Action.STOP):
        world.step(action)
    pose, observation, frame = world.pose, world.observation, world.map_to_scene
    went_on = Trial(world, episode_from(START, "sofa"), goes_on=True)
    assert world.pose == pose != START
    assert went_on.observation.robot == observation.robot
    assert np.array_equal(went_on.observation.depth, observation.depth)
    assert world.map_to_scene == frame
    assert not went_on.is_over


def test_a_search_of_a_life_is_measured_from_where_the_robot_stands():
    world = two_rooms(coloured=False)
    world.reset(episode_from(START, "sofa"))
    world.step(Action.MOVE_FORWARD)
    trial = Trial(world, episode_from(START, "sofa"), goes_on=True)
    there = world.goal_truth(trial.episode.goal).distance(*world.position)
    trial.take(Action.STOP)
    assert trial.measure().shortest_path_m == there
    assert trial.measure().path_length_m == 0.0


def test_a_world_in_which_no_robot_stands_cannot_go_on():
    fresh = colourless_world(two_rooms().scene, small_config())
    with pytest.raises(WorldError, match="before reset"):
        fresh.go_on(episode_from(START))
    fresh.close()


def test_a_world_without_that_ability_is_refused_by_name():
    class OnlyOnce:
        embodiment, is_over, collided, truth = small_config().embodiment, False, False, None

        def reset(self, episode, rng=None):
            raise AssertionError

        def step(self, action):
            raise AssertionError

    with pytest.raises(WorldError, match="OnlyOnce has no go_on"):
        Trial(OnlyOnce(), episode_from(START), goes_on=True)


def test_what_was_learned_for_one_goal_is_known_when_the_next_is_asked_for():
    agent = remembering()
    first = searched(agent, "bed").result()
    memory = agent.memory
    second = searched(agent, "sofa", goes_on=True).result()
    assert agent.memory is memory
    assert (first.outcome, second.outcome) == (Outcome.FOUND, Outcome.FOUND)
    anew = remembering()
    searched(anew, "bed")
    assert anew.memory is not memory
    assert len(memory.floor.trajectory) == first.steps + second.steps
