"""The published methods in the search that they share with ours."""

import math

import numpy as np
import pytest

import hypernav
from hypernav.app.build.agents import build_agent, build_search
from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.presets import preset
from hypernav.core.episode import Outcome
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog, without_timings
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from hypernav.simulator.worlds.simulation import SimulatedWorld
from hypernav.simulator.worlds.surface.goal_regions import random_start
from small_episodes import episode_from
from small_worlds import small_config, two_rooms

RIVALS = ("vlfm", "navvlm", "vlmnav", "pivot", "dynavlm-style")
START = Pose2(2.5, 1.0, math.pi / 2)


def searched(agent: str, seed: int = 0):
    """A search of two rooms, step by step, and its result."""
    parts = build_agent(small_config(), ComponentSpecs(agent=agent))
    episode = episode_from(START, "bed", max_steps=200)
    run = EpisodeRun(
        parts.agent,
        two_rooms(coloured=False),
        episode,
        rng=np.random.default_rng(seed),
        told=parts.truth,
    )
    steps = [step.trace.model_dump(mode="json") for step in run if step.trace is not None]
    return [without_timings(step) for step in steps], run.result()


@pytest.mark.parametrize("agent", RIVALS)
def test_the_contract_of_agents_is_kept(agent):
    built = build_search(small_config(), GroundTruthDetector(), ExchangeLog(), agent=agent)
    hypernav.check_agent(built)


@pytest.mark.parametrize("agent", RIVALS)
def test_the_bed_behind_the_wall_is_found_and_equal_seeds_give_equal_searches(agent):
    steps, result = searched(agent)
    assert result.outcome is Outcome.FOUND
    assert searched(agent)[0] == steps


@pytest.mark.slow
@pytest.mark.parametrize("agent", RIVALS)
def test_the_bed_of_a_real_house_is_found(agent, small_house):
    from hypernav.simulator.worlds.scenes.loading import read_scene

    config = preset("default")
    world = SimulatedWorld(read_scene(small_house), config.world, config.embodiment)
    rng = np.random.default_rng(0)
    start = random_start(world.walkable, rng, world.regions.of(Goal("bed")))
    parts = build_agent(config, ComponentSpecs(agent=agent))
    run = EpisodeRun(
        parts.agent, world, episode_from(start, "bed", max_steps=500), rng=rng, told=parts.truth
    )
    for _ in run:
        pass
    assert run.result().outcome is Outcome.FOUND
