"""Tests what the exam predicts: fourteen stand-ins sit it, and then search.

Each stand-in answers the questions of an exam of the training bank. From the answers alone it is
predicted what it reaches in searches; then it searches itself, in the same episodes.

    python benchmarks/exam_prediction.py --out runs/exam-prediction --episodes 100

An interrupted test goes on with the same command.
"""

import argparse
import hashlib
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from pydantic import TypeAdapter
from scipy.stats import spearmanr

from hypernav.app.build.agents import build_search
from hypernav.app.build.presets import HyPerNavConfig, preset
from hypernav.core.components.protocols import BlockReasoner, Detector
from hypernav.core.episode import EpisodeTruth
from hypernav.core.exploring.overview import BlockChoice, Overview
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import ExchangeLog
from hypernav.lab.evaluation.statistics import compare, mean_with_interval
from hypernav.lab.exam.bank import Bank, ExamSize, Sheet
from hypernav.lab.exam.examinee import truth_of
from hypernav.lab.exam.gathering import questions_of
from hypernav.lab.exam.marking import Given, marked
from hypernav.lab.exam.prediction.confusion import confusion_of
from hypernav.lab.exam.prediction.mimics import Asked
from hypernav.lab.exam.prediction.searches import (
    SearchedEpisode,
    mimic_agent,
    run_searches,
    spread_episodes,
)
from hypernav.lab.exam.questions import Answered, ExamQuestion
from hypernav.search.agents.search import SearchAgent
from hypernav.search.perception.config import VlmReasonerConfig
from hypernav.search.perception.explorers.map_question import offered_blocks
from hypernav.search.perception.explorers.noisy_reasoner import NoisyReasoner, RandomReasoner
from hypernav.search.perception.local.stand_ins.ground_truth import (
    true_detection,
    true_labels,
    visible_objects,
)
from hypernav.search.perception.local.stand_ins.noisy_detector import (
    NoisyDetector,
    distance_to,
    resembles,
)
from hypernav.search.perception.local.stand_ins.systematic_detector import (
    STANDARD_NORMAL,
    SystematicDetector,
    normal,
    uniform,
    view_of,
)

NEAR = 0.04
"""Difference of SPL up to which a prediction is right."""
BY_BLOCK = {
    "first": lambda block: block.number,
    "nearest": lambda block: (block.travel_m, block.number),
}


@dataclass(frozen=True)
class Rule:
    """Chooses the block that is least by some measure, whatever the goal."""

    config: VlmReasonerConfig
    measure: Callable

    def choose(self, overview: Overview, goal: Goal, excluded: frozenset[int]) -> BlockChoice:
        """The block that is least."""
        offered = offered_blocks(self.config, overview, excluded)
        return BlockChoice(min(offered, key=self.measure).number if offered else None, "a rule")


@dataclass(frozen=True)
class Eyes:
    """Sees all that is labelled, but not from afar, or askew, or things alike as well."""

    kind: str
    looks_at_colours: bool = False

    def detect(self, observation: Observation, goal: Goal) -> list[Detection]:
        """What is seen, as boxes."""
        truth, found = true_labels(observation), []
        for number in visible_objects(truth):
            label, true = truth.labels[number], true_detection(truth, number)
            is_it = label.satisfies(goal)
            key = (self.kind, number, goal.text)
            if self.kind == "alike" and not is_it:
                is_it = resembles(label, goal) and uniform(key) < 0.7
            if self.kind == "far-blind" and is_it:
                is_it = distance_to(true, observation) <= 2.0
            if is_it:
                box = _askew(true, observation, key) if self.kind == "askew" else true.box
                found.append(Detection(box, 1.0, goal.thing))
        return found


def _askew(true: Detection, observation: Observation, key: tuple) -> Box:
    """A box whose edges are wrong by a quarter of its sides; the same in similar views."""
    box, (height, width) = true.box, observation.depth.shape
    view = view_of(true, observation)
    by = [0.25 * normal((*key, *view, edge)) for edge in range(4)]
    w, h = box.x_max - box.x_min, box.y_max - box.y_min
    x_min = float(np.clip(box.x_min + by[0] * w, 0.0, width - 1.0))
    y_min = float(np.clip(box.y_min + by[1] * h, 0.0, height - 1.0))
    x_max = float(np.clip(box.x_max + by[2] * w, x_min + 1.0, width))
    y_max = float(np.clip(box.y_max + by[3] * h, y_min + 1.0, height))
    return Box(x_min, y_min, x_max, y_max)


@dataclass(frozen=True)
class Check:
    """Says yes at these rates: goal there, something alike, something else."""

    rates: tuple[float, float, float]

    def is_present(self, observation: Observation, goal: Goal) -> bool:
        """The answer; about one thing always the same."""
        truth = true_labels(observation)
        shown = visible_objects(truth)
        there = [n for n in shown if truth.labels[n].satisfies(goal)]
        alike = [n for n in shown if resembles(truth.labels[n], goal)]
        about = next(iter(there or alike or shown), -1)
        rate = self.rates[0 if there else 1 if alike else 2]
        return uniform(("check", about, goal.text)) < rate


STAND_INS: dict[str, tuple[str, str, tuple[float, float, float]]] = {
    "perfect": ("1.0", "perfect", (1.0, 0.0, 0.0)),
    "good": ("0.8", "systematic:good", (0.95, 0.2, 0.05)),
    "random blocks": ("random", "systematic:fair", (0.8, 0.4, 0.2)),
    "always the first block": ("first", "perfect", (1.0, 0.0, 0.0)),
    "nearest block, poor eyes": ("nearest", "systematic:poor", (0.9, 0.3, 0.1)),
    "always yes": ("0.6", "alike", (1.0, 1.0, 1.0)),
    "mostly no": ("0.8", "perfect", (0.4, 0.0, 0.0)),
    "blind from 2 m on": ("0.7", "far-blind", (1.0, 0.0, 0.0)),
    "boxes askew": ("0.7", "askew", (1.0, 0.1, 0.0)),
    "confuses what is alike": ("0.5", "alike", (0.95, 0.8, 0.3)),
}
"""Blocks (probability of the best, or a rule), eyes, and rates of "yes" of the check."""

UNSEEN: dict[str, tuple[str, str, tuple[float, float, float]]] = {
    "fair all round": ("0.7", "systematic:fair", (0.9, 0.3, 0.1)),
    "fine blocks, poor eyes": ("1.0", "systematic:poor", (0.95, 0.1, 0.05)),
    "nearest block, alike, doubts": ("nearest", "alike", (0.7, 0.2, 0.0)),
    "random blocks, blind afar": ("random", "far-blind", (0.85, 0.0, 0.0)),
}
"""Others, on which nothing was tuned: they were written before any of them was run."""
ALL = STAND_INS | UNSEEN


def reasoner_of(name: str, truth: EpisodeTruth, config: VlmReasonerConfig) -> BlockReasoner:
    if name in BY_BLOCK:
        return Rule(config, BY_BLOCK[name])
    if name == "random":
        return RandomReasoner(ExchangeLog(), truth, config)
    return NoisyReasoner(name, ExchangeLog(), truth, config)


def detector_of(name: str, truth: EpisodeTruth) -> Detector:
    if name == "perfect":
        return NoisyDetector(name, truth)
    kind, _, level = name.partition(":")
    return SystematicDetector(level) if kind == "systematic" else Eyes(name)


def agent_of(who: str, config: HyPerNavConfig, truth: EpisodeTruth, asked: Asked) -> SearchAgent:
    blocks, eyes, rates = ALL[who]
    return build_search(
        config,
        detector_of(eyes, truth),
        reasoner=reasoner_of(blocks, truth, config.block_choice),
        presence=Check(rates),
    )


def exam_of(who: str, questions: list[ExamQuestion], config: HyPerNavConfig) -> list[Answered]:
    """The answers of a stand-in to the questions of an exam."""
    blocks, eyes, rates = ALL[who]
    answers = []
    for question in questions:
        truth, goal = EpisodeTruth(), question.goal
        seed = hashlib.sha256(f"{who}/{question.id}".encode()).digest()  # no luck in common
        rng = np.random.default_rng(int.from_bytes(seed[:8]))
        truth.tell(rng=rng, path_left_m=truth_of(question).path_left_m)
        if isinstance(question.subject, Overview):
            chosen = reasoner_of(blocks, truth, config.block_choice).choose(
                question.subject, goal, frozenset()
            )
            answers.append(marked(question, Given(str(chosen.number)), []))
            continue
        assert isinstance(question.subject, Observation)
        if question.kind == "boxes":
            found = tuple(detector_of(eyes, truth).detect(question.subject, goal))
            given = Given(found=found, probability=max((o.score for o in found), default=None))
        else:
            is_there = Check(rates).is_present(question.subject, goal)
            given = Given("yes" if is_there else "no")
        answers.append(marked(question, given, []))
    return answers


def gathered(config: HyPerNavConfig, size: ExamSize, workers: int) -> list[ExamQuestion]:
    """The questions of an exam of the training bank."""
    bank = Bank("train", size, ("block", "boxes", "presence"))
    taken, questions = Counter(), []
    pool = ProcessPoolExecutor(workers)
    for some in pool.map(partial(sheet_of, bank, config), bank.sheets()):
        if sum(taken.values()) >= bank.count:
            break
        chosen = bank.choose(some, taken)
        taken.update((one.kind, one.stratum) for one in chosen)
        questions += chosen
    pool.shutdown(cancel_futures=True)
    return questions


def sheet_of(bank: Bank, config: HyPerNavConfig, sheet: Sheet) -> list[ExamQuestion]:
    """As many questions of a sheet as an exam may take of it."""
    return bank.choose(questions_of(sheet, config), Counter())


def answers_of(
    folder: Path, config: HyPerNavConfig, size: ExamSize, workers: int = 1
) -> dict[str, list[Answered]]:
    """The answers of all stand-ins, read from the folder if they are there."""
    path = folder / f"answers-{size}.json"
    form = TypeAdapter(dict[str, list[Answered]])
    if not path.exists():
        questions = gathered(config, size, workers)
        found = {who: exam_of(who, questions, config) for who in ALL}
        path.write_bytes(form.dump_json(found))
    return form.validate_json(path.read_bytes())


@dataclass(frozen=True)
class Task:
    """Some searches of a stand-in, or of the prediction's stand-in for it.

    Attributes:
        who: The stand-in.
        is_measured: Whether it searches itself.
        part: Number of the task among those that share the episodes.
    """

    who: str
    is_measured: bool
    part: int


def searched(
    task: Task,
    parts: int,
    folder: Path,
    config: HyPerNavConfig,
    name: str,
    size: ExamSize,
    count: int,
) -> list[SearchedEpisode]:
    """The searches of a task, in its own file."""
    episodes = spread_episodes(config, count)
    scenes = sorted({one.scene_id for one in episodes})[task.part :: parts]
    mine = [one for one in episodes if one.scene_id in scenes]
    make = partial(agent_of, task.who, config)
    if not task.is_measured:
        confusion = confusion_of(answers_of(folder, config, size)[task.who])
        make = partial(mimic_agent, confusion, config, "model")
    what = "measured" if task.is_measured else "predicted"
    who = task.who.replace(" ", "-").replace(",", "")
    path = folder / f"{name}-{who}-{what}-{task.part}-of-{parts}.jsonl"
    return run_searches({(name, "model"): make}, config, mine, path, lambda _: None)


def main() -> None:
    parser = argparse.ArgumentParser(description="Test what the exam predicts.")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--episodes", type=int, default=100)
    parser.add_argument("--presets", nargs="+", default=["default", "paper"])
    parser.add_argument("--size", default="full", choices=["quick", "full"])
    parser.add_argument("--only", nargs="*", default=list(ALL))
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--parts", type=int, default=5, help="into how many files searches go")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    camera = {"embodiment": {"camera": {"width": 320, "height": 240}}}
    configs = {name: preset(name).with_(**camera) for name in options.presets}
    answers = answers_of(options.out, next(iter(configs.values())), options.size, options.workers)
    print(f"{len(answers['perfect'])} questions, {options.episodes} episodes", flush=True)
    kinds = (False, True)
    with ProcessPoolExecutor(options.workers) as pool:
        for name, config in configs.items():
            under_way = {
                task: pool.submit(
                    searched,
                    *(task, options.parts, options.out, config, name, options.size),
                    options.episodes,
                )
                for part in range(options.parts)
                for who in options.only
                for task in (Task(who, kind, part) for kind in kinds)
            }
            results = {task: future.result() for task, future in under_way.items()}
            print_table(name, options.only, results)


def print_table(name: str, names: list[str], results: dict[Task, list[SearchedEpisode]]) -> None:
    """Predictions beside what was measured, and how far apart they are."""
    predicted, measured, inside, by_luck = [], [], 0, 0.0
    print(f"\n{name}: SPL predicted, measured, measured less predicted; SR predicted, measured")
    for who in names:
        spl, found, scenes = [], [], []
        for is_measured in (False, True):
            done = [
                one
                for task, some in results.items()
                if (task.who, task.is_measured) == (who, is_measured)
                for one in some
            ]
            spl.append([episode.searches[0].spl for episode in done])
            found.append([float(episode.searches[0].success) for episode in done])
            scenes = [episode.scene_id for episode in done]
        said = mean_with_interval(spl[0], scenes)
        gap = compare(spl[0], spl[1], scenes).difference
        predicted.append(said.mean)
        measured.append(float(np.mean(spl[1])))
        inside += said.low <= measured[-1] <= said.high
        error = (gap.high - gap.low) / (2.0 * STANDARD_NORMAL.inv_cdf(0.975))
        by_luck += 2.0 * STANDARD_NORMAL.cdf(NEAR / max(error, 1e-9)) - 1.0
        print(
            f"| {who} | {said.mean:.3f} ({said.low:.2f} to {said.high:.2f}) | "
            f"{measured[-1]:.3f} | {gap.mean:+.3f} ({gap.low:+.2f} to {gap.high:+.2f}) | "
            f"{np.mean(found[0]):.2f} | {np.mean(found[1]):.2f} |",
            flush=True,
        )
    gaps = np.abs(np.array(predicted) - np.array(measured))
    ranks = float(spearmanr(predicted, measured)[0])  # pyright: ignore[reportArgumentType]
    print(
        f"{name}: rank correlation {ranks:.3f}; within {NEAR}: {(gaps <= NEAR).sum()} of "
        f"{gaps.size} (of stand-ins that err alike, {by_luck:.1f}), mean {gaps.mean():.3f}, "
        f"largest {gaps.max():.3f}; inside the interval: {inside}",
        flush=True,
    )


if __name__ == "__main__":
    main()
