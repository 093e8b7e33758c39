"""`hm3d:` on scans of several storeys: a robot that climbs, one that doesn't, and known levels."""

from contextlib import closing
from dataclasses import replace

import numpy as np
import pytest

from hypernav.app.build.agents import build_search
from hypernav.app.build.data.datasets import load_episodes
from hypernav.app.build.data.scenes import load_scene
from hypernav.core.embodiment import STAIR_CLIMB_M
from hypernav.core.episode import Episode, Outcome
from hypernav.core.trace import ExchangeLog
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from hypernav.simulator.worlds.navmesh.navmesh_surface import NavmeshSurface
from hypernav.simulator.worlds.simulation import SimulatedWorld
from small_worlds import small_config

_MOTION = {"forward_m": 0.25, "turn_angle_deg": 30.0}
_LEVEL_M = 0.15
"""Habitat's mesh is up to a cell above the floor, and a robot's floor within its first step."""


@pytest.fixture(scope="module")
def from_below(benchmark_data) -> Episode:
    """The search for the couch, which is above, from the start of the one for the chair, below."""
    chair, _, _, couch = load_episodes(f"hm3d:{benchmark_data}#v1/val")
    return replace(couch, episode_id="4", start=chair.start, start_z=chair.start_z)


@pytest.fixture(scope="module")
def in_a_tower(tmp_path_factory) -> list[Episode]:
    """Searches of a scan with three storeys and no railings: two floors up, one up, one down."""
    from scan_writers.data_folder import write_tower  # After the hook of conftest.

    folder = write_tower(tmp_path_factory.mktemp("tower") / "data")
    return load_episodes(f"hm3d:{folder}#v1/val")


def levels_of(heights: np.ndarray) -> list[float]:
    """Heights that at least a tenth of the points of a mesh share; those of stairs don't."""
    found, counts = np.unique(np.round(heights, 1), return_counts=True)
    return [float(z) for z in found[counts >= 0.1 * len(heights)]]


def search(episode: Episode, max_step_m: float) -> tuple[Outcome, list[float], list[float]]:
    """Outcome, the levels that the agent knows, and those of the mesh; scene frame, metres."""
    body = {"max_step_m": max_step_m}
    config = small_config(embodiment={"motion": _MOTION, "body": body})
    agent = build_search(config, GroundTruthDetector(), ExchangeLog())
    scene = load_scene(episode.scene_id)
    with closing(SimulatedWorld(scene, config.world, config.embodiment)) as world:
        run = EpisodeRun(agent, world, episode)
        for _ in run:
            pass
        assert isinstance(world.walkable, NavmeshSurface)
        start_z = episode.start_z or 0.0
        known = sorted(floor.z + start_z for floor in agent.memory.floors)
        return run.result().outcome, known, levels_of(world.walkable.floor[:, 2])


@pytest.mark.slow
def test_a_robot_that_climbs_finds_the_goal_above_and_knows_the_levels_of_the_mesh(from_below):
    outcome, known, levels = search(from_below, STAIR_CLIMB_M)
    assert outcome is Outcome.FOUND
    assert known == pytest.approx(levels, abs=_LEVEL_M)


@pytest.mark.slow
def test_a_robot_that_does_not_climb_stays_on_its_floor(from_below):
    outcome, known, levels = search(replace(from_below, max_steps=150), 0.1)
    assert outcome is not Outcome.FOUND
    assert len(levels) == 2
    assert known == pytest.approx(levels[:1], abs=_LEVEL_M)


@pytest.mark.slow
@pytest.mark.parametrize(("number", "seen"), [(0, [0, 1, 2]), (1, [1, 2]), (2, [1, 2])])
def test_it_goes_up_and_down_in_open_stairwells(in_a_tower, number, seen):
    outcome, known, levels = search(in_a_tower[number], STAIR_CLIMB_M)
    assert outcome is Outcome.FOUND
    assert len(levels) == 3
    assert known == pytest.approx([levels[k] for k in seen], abs=_LEVEL_M)
