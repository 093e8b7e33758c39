"""Count the questions of a search, per preset and with each saving switched on or off.

Every search asks the scripted model server of the tests over a socket; it answers with the
simulator's ground truth, so the lines of the table differ only in how often it is asked, and when.

    python benchmarks/model_calls.py                         # small_house, 4 goals from 2 starts
    python benchmarks/model_calls.py --scenes houses:100000 houses:100001 --goals bed sofa

`waited` is what the questions would take with `--question-s` and `--map-question-s` seconds each.
"""

import os
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import tyro
from rich.console import Console
from rich.table import Table

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "tests"))

from hypernav.app.build.agents import build_agent  # noqa: E402
from hypernav.app.build.components.component_specs import (  # noqa: E402
    ComponentSpecs,
    PresetName,
)
from hypernav.app.build.data.scenes import load_scene  # noqa: E402
from hypernav.app.build.presets import preset  # noqa: E402
from hypernav.core.episode import Episode  # noqa: E402
from hypernav.core.goal import Goal  # noqa: E402
from hypernav.io.layered_config import layered  # noqa: E402
from hypernav.lab.episodes.episode_run import EpisodeRun  # noqa: E402
from hypernav.simulator.worlds.simulation import SimulatedWorld  # noqa: E402
from hypernav.simulator.worlds.surface.goal_regions import random_start  # noqa: E402
from servers.scripted import ScriptedServer  # noqa: E402
from servers.truth import Truth, TruthfulBrain, watching  # noqa: E402

SMALL_HOUSE = (
    Path(os.environ.get("HYPERNAV_TEST_DATA", ROOT.parent / "shared" / "data"))
    / "scenes"
    / "small_house"
    / "scene.glb"
)
VARIANTS: dict[str, tuple[PresetName, tuple[str, ...]]] = {
    "paper": ("paper", ()),
    "default": ("default", ()),
    "no crops": ("default", ("grounding.score_crops=0",)),
    "at destinations": ("default", ("search.looks=at-destinations",)),
}


@dataclass
class Tally:
    """Sums over the searches of one variant of the configuration."""

    found: int = 0
    spl: list[float] = field(default_factory=list)
    steps: list[int] = field(default_factory=list)
    calls: dict[str, int] = field(default_factory=dict)


def search(
    world: SimulatedWorld, goal: Goal, seed: int, variant: str, tally: Tally, set: tuple[str, ...]
) -> None:
    name, assignments = VARIANTS[variant]
    config = layered(preset(name), assignments=(*assignments, *set))
    rng = np.random.default_rng(seed)
    start = random_start(world.walkable, rng, world.regions.of(goal))
    with ScriptedServer() as server, watching(Truth()) as truth:
        server.brain = TruthfulBrain(truth)
        parts = build_agent(config, ComponentSpecs(vlm=server.spec))
        episode = Episode(world.scene.name, "", goal, start)
        run = EpisodeRun(parts.agent, world, episode, rng=rng)
        for _ in run:
            pass
        report = parts.take_report()
    result = run.result()
    tally.found += result.metrics.success
    tally.spl.append(result.metrics.spl)
    tally.steps.append(result.steps)
    for kind, row in report["ledger"]["kinds"].items():
        tally.calls[kind] = tally.calls.get(kind, 0) + row["calls"]


def worlds(scenes: tuple[str, ...], set: tuple[str, ...]) -> Iterator[SimulatedWorld]:
    config = layered(preset("default"), assignments=set)
    for scene in scenes:
        yield SimulatedWorld(load_scene(scene), config.world, config.embodiment)


def main(
    scenes: tuple[str, ...] = (str(SMALL_HOUSE),),
    goals: tuple[str, ...] = ("bed", "sofa", "refrigerator", "tv"),
    seeds: int = 2,
    variants: tuple[str, ...] = tuple(VARIANTS),
    question_s: float = 0.5,
    map_question_s: float = 0.7,
    set: tuple[str, ...] = (),
) -> None:
    """Run all and print the table so far after every goal.

    Args:
        scenes: The buildings, as for `hypernav find --scene`.
        goals: The objects to find; one that a scene lacks is skipped there.
        seeds: Number of starts per goal.
        variants: Names of the variants, one line of the table each.
        question_s: Assumed time of a question about a camera image, seconds.
        map_question_s: Assumed time of a question about the map, seconds.
        set: Single values of the configuration, as for `hypernav find --set`.
    """
    tallies = {variant: Tally() for variant in variants}
    console = Console(highlight=False, width=140)
    for world in worlds(scenes, set):
        for goal in map(Goal, goals):
            if not world.regions.of(goal).instances:
                continue
            for seed in range(seeds):
                for variant, tally in tallies.items():
                    search(world, goal, seed, variant, tally, set)
            console.print(f"after {goal.text} in {world.scene.name}:")
            console.print(table(tallies, question_s, map_question_s))


def table(tallies: dict[str, Tally], question_s: float, map_question_s: float) -> Table:
    columns = (
        "found",
        "SPL",
        "steps",
        "ground",
        "crop",
        "map",
        "verify",
        "calls",
        "waited",
    )
    rows = Table("per search", *columns)
    for variant, tally in tallies.items():
        n = len(tally.steps)
        ground, crop, verify = (tally.calls.get(kind, 0) for kind in ("ground", "crop", "verify"))
        of_map = tally.calls.get("choose block", 0) + tally.calls.get("summarise", 0)
        waited = question_s * (ground + crop + verify) + map_question_s * of_map
        rows.add_row(
            variant,
            f"{tally.found} of {n}",
            f"{np.mean(tally.spl):.3f}",
            f"{np.mean(tally.steps):.0f}",
            *(f"{count / n:.1f}" for count in (ground, crop, of_map, verify)),
            f"{sum(tally.calls.values()) / n:.1f}",
            f"{waited / n:.0f} s",
        )
    return rows


if __name__ == "__main__":
    tyro.cli(main)
