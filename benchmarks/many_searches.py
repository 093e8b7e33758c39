"""Run many searches in one building and print the table.

Run: python benchmarks/many_searches.py --scene small_house/scene.glb --goals bed sofa tv

Every search is what `hypernav find GOAL --scene SCENE --agent AGENT --seed SEED` does, without
video and page. Lines come as the searches end; the table follows.
"""

import multiprocessing
import os
from collections import defaultdict
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import tyro
from rich.console import Console
from rich.table import Table

from hypernav.app.build.agents import build_agent
from hypernav.app.build.components.component_specs import ComponentSpecs, PresetName
from hypernav.app.build.data.scenes import load_scene
from hypernav.app.build.presets import preset
from hypernav.core.episode import Episode
from hypernav.core.goal import Goal
from hypernav.io.layered_config import layered
from hypernav.lab.episodes.episode_run import EpisodeResult, EpisodeRun
from hypernav.simulator.worlds.simulation import SimulatedWorld
from hypernav.simulator.worlds.surface.goal_regions import random_start

SMALL_HOUSE = (
    Path(os.environ.get("HYPERNAV_TEST_DATA", "../shared/data"))
    / "scenes"
    / "small_house"
    / "scene.glb"
)
GOALS = (
    "bed",
    "sofa",
    "refrigerator",
    "tv",
    "wardrobe",
    "dining table",
    "exercise equipment",
    "chair",
)


class Search(NamedTuple):
    """One line of the table."""

    scene: str
    agent: str
    goal: str
    seed: int
    detector: str
    preset: PresetName
    assignments: tuple[str, ...]


@cache
def world_of(scene: str, preset_name: PresetName, assignments: tuple[str, ...]) -> SimulatedWorld:
    config = layered(preset(preset_name), assignments=assignments)
    return SimulatedWorld(load_scene(scene), config.world, config.embodiment)


def run(search: Search) -> tuple[Search, EpisodeResult, list[str]]:
    config = layered(preset(search.preset), assignments=search.assignments)
    world = world_of(search.scene, search.preset, search.assignments)
    goal, rng = Goal(search.goal), np.random.default_rng(search.seed)
    start = random_start(world.walkable, rng, world.regions.of(goal))
    parts = build_agent(config, ComponentSpecs(agent=search.agent, detector=search.detector))
    run = EpisodeRun(parts.agent, world, Episode(search.scene, "", goal, start), rng=rng)
    events = [event for step in run for event in step.trace.events]
    return search, run.result(), events


def main(
    scene: str = str(SMALL_HOUSE),
    goals: tuple[str, ...] = GOALS,
    agents: tuple[str, ...] = ("hypernav", "frontier"),
    seeds: int = 5,
    detector: str = "ground-truth",
    preset: PresetName = "default",
    set: tuple[str, ...] = (),
    workers: int = 2,
) -> None:
    """Search for every goal from every start with every agent.

    Args:
        scene: The building, as for `hypernav find --scene`.
        goals: The objects to find.
        agents: Names of the agents.
        seeds: Number of starts per goal, with the seeds 0, 1, …
        detector: The detector, as for `hypernav find --detector`.
        preset: Name of the preset, as for `hypernav find --preset`.
        set: Single values of the configuration, as for `hypernav find --set`.
        workers: Number of processes.
    """
    searches = [
        Search(scene, agent, goal, seed, detector, preset, set)
        for goal in goals
        for seed in range(seeds)
        for agent in agents
    ]
    console, results = Console(highlight=False, width=160), []
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(workers, mp_context=context) as pool:
        for search, result, events in pool.map(run, searches):
            results.append((search, result))
            console.print(line(search, result, events))
    console.print(summary(results))


def line(search: Search, result: EpisodeResult, events: list[str]) -> str:
    metrics = result.metrics
    return (
        f"{search.agent:9s} {search.goal:20s} seed {search.seed}  {result.outcome:12s} "
        f"SPL {metrics.spl:.2f}  steps {result.steps:3d}  "
        f"path {metrics.path_length_m:5.1f} m  shortest {metrics.shortest_path_m:5.1f} m  "
        f"left {metrics.distance_to_goal_m:.2f} m  {'' if metrics.success else events[-4:]}"
    )


def summary(results: list[tuple[Search, EpisodeResult]]) -> Table:
    by_agent = defaultdict(list)
    for search, result in results:
        by_agent[search.agent].append(result)
    table = Table("agent", "success", "SPL", "SoftSPL", "steps")
    for agent, found in by_agent.items():
        table.add_row(
            agent,
            f"{sum(r.metrics.success for r in found)} of {len(found)}",
            f"{np.mean([r.metrics.spl for r in found]):.3f}",
            f"{np.mean([r.metrics.soft_spl for r in found]):.3f}",
            f"{np.mean([r.steps for r in found]):.0f}",
        )
    return table


if __name__ == "__main__":
    tyro.cli(main)
