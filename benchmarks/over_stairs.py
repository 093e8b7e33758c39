"""Searches over stairs, by where the goal is: on the floor of the start, above it, or below it.

python benchmarks/over_stairs.py storeys-train#3000:3010 --last 230 --every 10
python benchmarks/over_stairs.py storeys-train#3000:3010 --last 230 --every 10 \
        --set search.use_stairs=false
python benchmarks/over_stairs.py storeys-train#3020:3045 --last 700 --one-of-each below
python benchmarks/over_stairs.py storeys-val --workers 14
"""

import multiprocessing
from bisect import bisect
from collections import defaultdict
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro

from hypernav.app.build.component_specs import ComponentSpecs
from hypernav.app.build.data.datasets import load_episodes
from hypernav.app.build.presets import HyPerNavConfig, preset
from hypernav.core.episode import Episode
from hypernav.io.layered_config import layered
from hypernav.lab.evaluation.record import EpisodeRecord
from hypernav.lab.evaluation.workers.job import Job
from hypernav.lab.evaluation.workers.worker import EpisodeWorker
from hypernav.simulator.houses.building import Building
from hypernav.simulator.houses.episodes.building_truth import CLIMBING_BODY
from hypernav.simulator.houses.house_cache import cached_building

_ABOVE_FLOOR_M = 0.3
"""Height above a floor below which things that stand on it begin, metres."""


Where = Literal["same", "above", "below"]


def direction(episode: Episode) -> Where:
    """Where the goal of a search is, seen from its start."""
    scene = cached_building(Building("storeys", int(episode.scene_id.split(":")[1])))
    goal_z = next(
        one.box_min[2]
        for one in scene.instances
        if one.label is not None and one.label.satisfies(episode.goal)
    )
    start = bisect(scene.storeys, (episode.start_z or 0.0) + _ABOVE_FLOOR_M)
    goal = bisect(scene.storeys, goal_z + _ABOVE_FLOOR_M)
    return "same" if goal == start else "above" if goal > start else "below"


def chosen_of_each(episodes: Sequence[Episode], where: Where) -> list[Episode]:
    """One search of each building for a goal that is there, in turn another one."""
    buildings: dict[str, list[Episode]] = defaultdict(list)
    for one in episodes:
        if direction(one) == where:
            buildings[one.scene_id].append(one)
    return [group[(4 * k + 1) % len(group)] for k, group in enumerate(buildings.values())]


@dataclass(frozen=True)
class Found:
    """How a search ended."""

    where: str
    record: EpisodeRecord


def searched(config: HyPerNavConfig, episodes: Sequence[Episode]) -> list[Found]:
    """Run searches one after another."""
    worker = EpisodeWorker(Job(Path(), config, ComponentSpecs(agent="hypernav"), 0))
    found = list[Found]()
    for one in episodes:
        found.append(Found(direction(one), worker.run(one)))
        record = found[-1].record
        words = (one.scene_id, one.episode_id, one.goal.text, record.outcome, record.steps)
        print(found[-1].where, *words, f"{record.spl:.3f}", flush=True)
    return found


def main(
    split: Annotated[str, tyro.conf.Positional],
    /,
    first: int = 0,
    last: int = 300,
    every: int = 1,
    one_of_each: Where | None = None,
    workers: int = 1,
    set: tuple[str, ...] = (),
) -> None:
    """Run every n-th of the first searches of a split with ground-truth labels.

    Args:
        split: Split of buildings with storeys.
        first: Number of the first search.
        last: Number of searches from which they are taken.
        every: Distance between two of them.
        one_of_each: Where the goals of those searches are of which one in each building is run.
        workers: Number of processes; one runs all searches of a building.
        set: Changes of the `default` preset.
    """
    base = preset("default")
    robot = base.embodiment.model_copy(update={"body": CLIMBING_BODY})
    config = layered(base.model_copy(update={"embodiment": robot}), assignments=set)
    buildings: dict[str, list[Episode]] = defaultdict(list)
    episodes = load_episodes(split)[first:last:every]
    if one_of_each is not None:
        episodes = chosen_of_each(episodes, one_of_each)
    for one in episodes:
        buildings[one.scene_id].append(one)
    if workers == 1:
        found = searched(config, episodes)
    else:
        with ProcessPoolExecutor(workers, multiprocessing.get_context("spawn")) as pool:
            runs = [pool.submit(searched, config, group) for group in buildings.values()]
            found = [one for run in runs for one in run.result()]
    for where in ("same", "above", "below", "all"):
        chosen = [one.record for one in found if where in (one.where, "all")]
        count = sum(one.outcome == "found" for one in chosen)
        spl = sum(one.spl for one in chosen) / max(len(chosen), 1)
        print(f"{where}: {count} of {len(chosen)} found, SPL {spl:.3f}")


if __name__ == "__main__":
    tyro.cli(main)
