"""The options of `hypernav eval`."""

from dataclasses import dataclass, field
from pathlib import Path

import tyro

from hypernav.build.component_specs import BenchmarkName
from hypernav.cli.options.agent import AgentOptions, FlatAgentOptions
from hypernav.evaluation.choices import SaveChoice


@dataclass(frozen=True)
class Options:
    """The episodes, the agent, the number of workers, and the folder of the results."""

    dataset: tyro.conf.Positional[str]
    """houses-val, houses-ovon, houses-train[#FIRST:END], offices-…, shops-…, crowded-train,
    storeys-…, houses-life-val, houses-life-train, offices-life-…, storeys-life-…,
    scene:GLB[#STARTS], habitat:FILE, hm3d:DIR[#SPLIT], mp3d:DIR[#SPLIT], ovon:DIR[#SPLIT] or
    goat:DIR[#SPLIT]."""
    who: FlatAgentOptions = field(default_factory=AgentOptions)
    """The options that configure the agent."""
    out: Path | None = None
    """Folder of the run; runs/<dataset>-<agent> by default."""
    benchmark: BenchmarkName | None = None
    """Published robot, step limit and success distance; hm3d:, mp3d:, ovon: and goat: have their
    own.
    hypernav-paper-hm3d and -ovon also name goals as the files do."""
    episodes: str | None = None
    """Only these episodes, by position in the data set: FIRST:END (END is not included). Where
    there are lives, only these lives."""
    scenes: str | None = None
    """Only these scenes, separated by commas: names, house or HM3D numbers, or positions from 0."""
    goals: str | None = None
    """Only these goals, separated by commas."""
    goal_types: str | None = None
    """Only these types of GOAT-Bench's goals: object, description or both, with a comma between
    them; by default both. Image goals can't be run yet."""
    scenes_dir: Path | None = None
    """Folder of the scenes that the episodes name; by default the data set's own folder."""
    world: str = "native"
    """Simulator: our own, or habitat-sim if it is installed."""
    workers: int | None = None
    """Number of processes, one core each; by default the number of cores, but one with
    --vlm local:…, which every process loads."""
    ray: str | None = None
    """Address of a Ray cluster, or auto, to run the workers there instead."""
    save: SaveChoice = "none"
    """Episodes that keep their page and video: all, the failed ones, or none."""
    max_steps: int | None = None
    """Maximum number of steps of an episode; by default that of --native or of the benchmark,
    else 500."""
    success_distance: float | None = None
    """Distance to a view point that counts as reached, metres, by default the benchmark's, else
    0.1; reports show all others, too."""
    seed: int = 0
    """Seed of all noise."""
    fresh_memory: bool = False
    """Empty the memory before each goal of a life, to measure what the memory is worth."""
    plan: bool = False
    """Only say what the run would cost: by --exam, without any search; else by the first ten
    episodes, which the same command without --plan doesn't run again."""
    quiet: bool = False
    """Print errors only."""
