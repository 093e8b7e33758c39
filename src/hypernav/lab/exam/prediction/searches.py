"""Searches with stand-ins that err like an examined model, to say what the model would reach."""

import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from importlib.metadata import version
from itertools import groupby
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import BaseModel, ConfigDict

from hypernav.app.build.agents import build_search
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.app.build.worlds import open_world
from hypernav.core.episode import Episode, EpisodeTruth
from hypernav.core.trace import ExchangeLog
from hypernav.core.world import Simulator
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.lab.evaluation.record import EpisodeLine
from hypernav.lab.evaluation.run_plan import RunPlan
from hypernav.lab.evaluation.store.record_file import RecordFile
from hypernav.lab.exam.prediction.confusion import Confusion
from hypernav.lab.exam.prediction.mimics import Asked, MimicDetector, MimicPresence, MimicReasoner
from hypernav.search.agents.search import SearchAgent
from hypernav.search.perception.explorers.geometric_reasoner import GeometricReasoner
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector

Variant = Literal["model", "rule", "unchecked"]
"""Who is asked: the model, all that it was examined in; the geometric rule about blocks, in its
place; or nobody whether the goal is really there."""

SEARCHES = f"searches-{version('hypernav')}.jsonl"
"""File of the searches; stand-ins of another version of the program may err otherwise."""
DATASET = "houses-train"
"""The episodes of the searches."""


class Searched(BaseModel):
    """One search with stand-ins.

    Attributes:
        preset: Preset of the search.
        variant: Who was asked.
        success: Whether the goal was found.
        spl: Success weighted by path length.
        steps: Number of steps.
        asked: Number of questions, by kind.
        seconds: Time of the search without the model's, seconds.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    preset: str
    variant: Variant
    success: bool
    spl: float
    steps: int
    asked: dict[str, int]
    seconds: float


class SearchedEpisode(EpisodeLine):
    """All searches of one episode: a line of `SEARCHES`.

    Attributes:
        searches: With every preset and variant.
    """

    searches: list[Searched]


def variants_of(confusion: Confusion) -> tuple[Variant, ...]:
    """The model, and the model without each question that can be left out."""
    variants: list[Variant] = ["model"]
    if confusion.blocks:
        variants.append("rule")
    if confusion.presence:
        variants.append("unchecked")
    return tuple(variants)


def spread_episodes(config: HyPerNavConfig, count: int) -> list[Episode]:
    """Episodes for the searches, of as many buildings as possible; those of a building together.

    Args:
        config: Configuration of the robot.
        count: Number of episodes.
    """
    by_scene: dict[str, list[Episode]] = {}
    for episode in RunPlan(DATASET, config=config).episodes():
        by_scene.setdefault(episode.scene_id, []).append(episode)
    longest = max(map(len, by_scene.values()))
    spread = [few[k] for k in range(longest) for few in by_scene.values() if k < len(few)]
    return sorted(spread[:count], key=lambda one: one.scene_id)


MakeAgent = Callable[[EpisodeTruth, Asked], SearchAgent]
"""Makes an agent that uses the truth and counts its questions."""


def run_searches(
    agents: Mapping[tuple[str, Variant], MakeAgent],
    config: HyPerNavConfig,
    episodes: Sequence[Episode],
    path: Path,
    watch: Callable[[int], None],
) -> list[SearchedEpisode]:
    """Run all episodes with all agents; those that the file holds are not run again.

    Args:
        agents: Agents by preset and variant.
        config: Configuration of the robot.
        episodes: The episodes, those of a building one after the other.
        path: File of the searches.
        watch: Function that is called with the number of finished episodes.

    Returns:
        The searches of these episodes, in their order.

    Raises:
        RunFolderError: The file is damaged or can't be written.
    """
    file = RecordFile(path, SearchedEpisode)
    for scene_id, group in groupby(episodes, key=lambda one: one.scene_id):
        left = [episode for episode in group if episode.key not in file.records]
        if not left:
            continue
        opened = open_world(scene_id, config, threads=1)
        opened.colours = False
        try:
            for episode in left:
                file.add(
                    SearchedEpisode(
                        scene_id=scene_id,
                        episode_id=episode.episode_id,
                        searches=[
                            _searched(name, variant, make_agent, opened, episode)
                            for (name, variant), make_agent in agents.items()
                        ],
                    )
                )
                watch(len(file.records))
        finally:
            opened.close()
    return [file.records[episode.key] for episode in episodes]


def _searched(
    name: str, variant: Variant, make_agent: MakeAgent, world: Simulator, episode: Episode
) -> Searched:
    truth, asked = EpisodeTruth(), Asked()
    began = time.process_time()
    rng = np.random.default_rng(episode.seed(0))
    run = EpisodeRun(make_agent(truth, asked), world, episode, rng=rng, told=truth)
    for _ in run:
        pass
    result = run.result()
    return Searched(
        preset=name,
        variant=variant,
        success=result.metrics.success,
        spl=result.metrics.spl,
        steps=result.steps,
        asked=dict(sorted(asked.items())),
        seconds=round(time.process_time() - began, 2),
    )


def mimics_of(
    confusion: Confusion, configs: Mapping[str, HyPerNavConfig]
) -> dict[tuple[str, Variant], MakeAgent]:
    """Agents that err like an examined model.

    Args:
        confusion: How it errs.
        configs: Configurations by the names of their presets, all with the same robot.
    """
    return {
        (name, variant): partial(mimic_agent, confusion, config, variant)
        for name, config in configs.items()
        for variant in variants_of(confusion)
    }


def mimic_agent(
    confusion: Confusion,
    config: HyPerNavConfig,
    variant: Variant,
    truth: EpisodeTruth,
    asked: Asked,
) -> SearchAgent:
    """The search of this package with stand-ins for what was examined.

    What was not examined is as in a search without a model: true labels, the geometric rule, and no
    check of the presence.

    Args:
        confusion: How the examined model errs.
        config: Configuration of the search.
        variant: Who is asked.
        truth: Holder of the truth about the episodes.
        asked: Counter of the questions.
    """
    log = ExchangeLog()
    rule = GeometricReasoner(log, config.geometric)
    blocks = None if variant == "rule" else confusion.blocks
    check = confusion.presence and config.presence.enabled and variant != "unchecked"
    return build_search(
        config,
        MimicDetector(confusion.sight, confusion, asked, config.grounding.score_crops)
        if confusion.sight
        else GroundTruthDetector(),
        log,
        reasoner=MimicReasoner(blocks, truth, config.block_choice, rule, asked) if blocks else rule,
        presence=MimicPresence(confusion, asked, config.presence.unsure == "yes")
        if check
        else None,
    )
