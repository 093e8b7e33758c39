"""Summary of an episode's trace for its page: phases, floors, costs, times, and the story.

The story is what was asked and decided, in chapters.
"""

import math
import statistics
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby, takewhile
from typing import Any, TypeVar

from hypernav.app.show import captions
from hypernav.app.show.video_frame import EVERY_STEP, decisions
from hypernav.core.trace import Exchange, Mode, StepTrace, floor_of

_Value = TypeVar("_Value")
_NESTED_NAMES = ("modules", "per_module")
_SMALLEST_REMAINDER = 0.01

_MOST_BARS = 5
_AT_STAIRS_M = 1.0
"""Distance to its destination, metres, from which a robot on stairs was going to these."""
_CHAPTERS = {
    Mode.LOOK_AROUND: Mode.EXPLORE,
    Mode.RECALL: Mode.EXPLORE,
    Mode.VERIFY: Mode.APPROACH,
    Mode.STOP: Mode.APPROACH,
}
"""Mode by which a chapter goes, where it is not the step's own."""


@dataclass(frozen=True)
class Phase:
    """A run of consecutive steps in one mode.

    Attributes:
        mode: Mode of the steps.
        first: Index of the first step in the trace.
        count: Number of steps.
    """

    mode: Mode
    first: int
    count: int


def phases(steps: Sequence[StepTrace]) -> list[Phase]:
    """The episode as phases, in order."""
    return [Phase(*run) for run in runs(steps, lambda step: step.mode)]


@dataclass(frozen=True)
class Stay:
    """A run of consecutive steps on one floor, or on stairs from it.

    Attributes:
        floor: Number of the floor.
        on_stairs: Whether the robot was on stairs.
        first: Index of the first step in the trace.
        count: Number of steps.
    """

    floor: int
    on_stairs: bool
    first: int
    count: int


def stays(steps: Sequence[StepTrace]) -> list[Stay]:
    """The floors and stairs in the order in which the robot was on them."""
    found = runs(steps, lambda step: (floor_of(step), step.mode is Mode.CLIMB))
    return [Stay(*where, first, count) for where, first, count in found]


def runs(
    steps: Sequence[StepTrace], key: Callable[[StepTrace], _Value]
) -> Iterator[tuple[_Value, int, int]]:
    """Runs of consecutive steps of one value: the value, the first step's index, their number."""
    first = 0
    for value, group in groupby(steps, key):
        count = sum(1 for _ in group)
        yield value, first, count
        first += count


@dataclass(frozen=True)
class ModeShare:
    """Share of an episode spent in one mode.

    Attributes:
        mode: Mode of the steps.
        count: Number of steps.
        share: Share of all steps, 0 to 1.
    """

    mode: Mode
    count: int
    share: float


def mode_shares(steps: Sequence[StepTrace]) -> list[ModeShare]:
    """Shares of the modes that occur, in the order of `Mode`."""
    counts = {mode: sum(step.mode == mode for step in steps) for mode in Mode}
    return [ModeShare(mode, n, n / len(steps)) for mode, n in counts.items() if n]


@dataclass(frozen=True)
class QuestionCosts:
    """Costs of the questions of one kind.

    Attributes:
        name: Name of the kind, for people.
        calls: Number of questions.
        tokens_in: Tokens read by the model.
        tokens_out: Tokens written by the model.
        seconds: Time spent waiting for answers.
        retries: Attempts beyond the first.
        unusable: Answers that could not be used, with their reasons; empty if all could.
    """

    name: str
    calls: int
    tokens_in: int
    tokens_out: int
    seconds: float
    retries: int
    unusable: str


def question_costs(result: Mapping[str, Any]) -> list[QuestionCosts]:
    """The ledger of a result: a row per kind of question, then the total; empty without one."""
    ledger = result.get("ledger")
    if not isinstance(ledger, Mapping) or not ledger.get("kinds"):
        return []
    rows = [(captions.QUESTIONS.get(kind, kind), row) for kind, row in ledger["kinds"].items()]
    return [_question_costs(name, row) for name, row in [*rows, ("All together", ledger["total"])]]


def _question_costs(name: str, row: Mapping[str, Any]) -> QuestionCosts:
    faults = ", ".join(f"{count} {reason}" for reason, count in row.get("faults", {}).items())
    return QuestionCosts(
        name=name,
        calls=row["calls"],
        tokens_in=row["tokens_in"],
        tokens_out=row["tokens_out"],
        seconds=float(row["seconds"]),
        retries=row["retries"],
        unusable=faults,
    )


@dataclass(frozen=True)
class ModuleTime:
    """Time spent in one module.

    Attributes:
        name: Name of the module, for people.
        seconds: Total time.
        share: Time relative to the longest module, 0 to 1.
        of_total: Share of the whole episode, 0 to 1.
        typical_s: Median over the steps in which it ran; None if the trace has no times.
    """

    name: str
    seconds: float
    share: float
    of_total: float
    typical_s: float | None


def module_times(result: Mapping[str, Any], steps: Sequence[StepTrace]) -> list[ModuleTime]:
    """Time per module, longest first.

    Args:
        result: Its ``seconds`` are read: ``total`` and one entry per module, either beside it or
            in a mapping named ``modules``. Without them the trace is added up.
        steps: The trace.
    """
    seconds = _seconds_by_module(result, steps)
    total = _number(_seconds_of(result).get("total")) or sum(seconds.values())
    rest = total - sum(seconds.values())
    if seconds and rest > _SMALLEST_REMAINDER * total:
        seconds["everything else"] = rest
    longest = max(seconds.values(), default=0.0)
    return [
        ModuleTime(
            name=captions.MODULES.get(name, name),
            seconds=spent,
            share=spent / longest if longest > 0.0 else 0.0,
            of_total=spent / total if total > 0.0 else 0.0,
            typical_s=_typical(name, steps),
        )
        for name, spent in sorted(seconds.items(), key=lambda item: -item[1])
    ]


def total_seconds(result: Mapping[str, Any]) -> float | None:
    """Duration of the episode, if the result holds it."""
    return _number(_seconds_of(result).get("total"))


def tokens(steps: Sequence[StepTrace]) -> tuple[int, int]:
    """Tokens that models read and wrote in all."""
    asked = [exchange for step in steps for exchange in step.exchanges]
    return sum(e.tokens_in for e in asked), sum(e.tokens_out for e in asked)


def _seconds_of(result: Mapping[str, Any]) -> Mapping[str, Any]:
    seconds = result.get("seconds")
    return seconds if isinstance(seconds, Mapping) else {"total": seconds}


def _seconds_by_module(result: Mapping[str, Any], steps: Sequence[StepTrace]) -> dict[str, float]:
    given = _seconds_of(result)
    nested = [given[name] for name in _NESTED_NAMES if isinstance(given.get(name), Mapping)]
    entries = nested[0] if nested else {k: v for k, v in given.items() if k != "total"}
    found = {str(k): value for k, v in entries.items() if (value := _number(v)) is not None}
    if not found:
        for step in steps:
            for name, spent in step.seconds.items():
                found[name] = found.get(name, 0.0) + spent
    return found


def _number(value: object) -> float | None:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        return None
    return float(value)


def _typical(name: str, steps: Sequence[StepTrace]) -> float | None:
    ran = [step.seconds[name] for step in steps if step.seconds.get(name)]
    return statistics.median(ran) if ran else None


@dataclass(frozen=True)
class AskedQuestion:
    """One question as the page shows it.

    Attributes:
        exchange: Question and answer.
        title: Subject of the question, in a few words.
        who: Name of the component that answered, for people.
        answer: Answer for people, even if the raw answer is for programs.
        likeliest: The likeliest answers with their probability, best first.
    """

    exchange: Exchange
    title: str
    who: str
    answer: str
    likeliest: tuple[tuple[str, float], ...]


@dataclass(frozen=True)
class KeyStep:
    """A step at which something was decided or happened.

    Attributes:
        index: Index of the step in the trace.
        step: Trace of the step.
        asked: Questions asked at the step.
    """

    index: int
    step: StepTrace
    asked: tuple[AskedQuestion, ...]


def key_steps(steps: Sequence[StepTrace]) -> list[KeyStep]:
    """The steps worth telling: those with a decision or an event.

    "Is it in the image?" is asked at every step, so it is shown only where its answer mattered: at
    an event of a step that sees the goal.
    """
    shown = []
    for index, step in enumerate(steps):
        seen = bool(step.events and step.detections)
        asked = tuple(
            _asked_question(e, step) for e in step.exchanges if seen or e.kind not in EVERY_STEP
        )
        if asked or step.events:
            shown.append(KeyStep(index, step, asked))
    return shown


@dataclass(frozen=True)
class Entry:
    """A step worth telling, and those at which the same was asked again on the way.

    Attributes:
        lead: The step.
        again: The later ones.
    """

    lead: KeyStep
    again: tuple[KeyStep, ...]


def entries(shown: Sequence[KeyStep]) -> list[Entry]:
    """The steps worth telling, where nothing but the same question followed, folded into one."""
    found = list[Entry]()
    for moment in shown:
        if found and _asks_again(moment, found[-1].lead):
            found[-1] = Entry(found[-1].lead, (*found[-1].again, moment))
        else:
            found.append(Entry(moment, ()))
    return found


def _asks_again(moment: KeyStep, lead: KeyStep) -> bool:
    kinds = [{asked.exchange.kind for asked in one.asked} for one in (moment, lead)]
    return not moment.step.events and moment.step.mode is lead.step.mode and kinds[0] == kinds[1]


@dataclass(frozen=True)
class Chapter:
    """A part of the story of a search.

    Attributes:
        mode: `Mode.EXPLORE` for all steps without the goal in sight, `Mode.CLIMB` for those on
            stairs, `Mode.APPROACH` for all others.
        floor: Number of the floor on which it takes place, or from which the stairs lead.
        first: Index of the first step in the trace.
        count: Number of steps.
        entries: What was asked and decided.
    """

    mode: Mode
    floor: int
    first: int
    count: int
    entries: tuple[Entry, ...]


def chapters(steps: Sequence[StepTrace]) -> list[Chapter]:
    """The story of a search: what it did on each floor, on stairs, and with the goal in sight."""
    shown = key_steps(steps)
    found = runs(steps, lambda step: (_CHAPTERS.get(step.mode, step.mode), floor_of(step)))
    return [
        Chapter(
            *what,
            first,
            count,
            tuple(entries([one for one in shown if first <= one.index < first + count])),
        )
        for what, first, count in found
    ]


def why_climbed(steps: Sequence[StepTrace], first: int) -> str:
    """Why the robot took stairs, in the words of who chose them; empty if nothing was said.

    Args:
        steps: The steps of a search.
        first: Index of the first step on the stairs.
    """
    before = steps[first - 1] if first else None
    if before is None or not before.reason:
        return ""
    why, going_to = before.reason, before.destination
    if going_to is None or math.dist(going_to, steps[first].pose[:2]) > _AT_STAIRS_M:
        return f"Met on the way to something else: {why}"
    going = takewhile(lambda step: step.destination == going_to, reversed(steps[:first]))
    asked = (one for step in going for one in reversed(decisions(step)))
    choice = next((one for one in asked if one.chosen is not None), None)
    who = "Chosen" if choice is None else f"{captions.answerer_caption(choice)} chose them"
    return f"{who}: {why}"


def _asked_question(exchange: Exchange, step: StepTrace) -> AskedQuestion:
    ranked = sorted(exchange.probabilities.items(), key=lambda item: -item[1])
    return AskedQuestion(
        exchange=exchange,
        title=captions.question_caption(exchange),
        who=captions.answerer_caption(exchange),
        answer=captions.detections_caption(step.detections)
        if exchange.kind == "ground"
        else exchange.answer,
        likeliest=tuple(ranked[:_MOST_BARS]),
    )
