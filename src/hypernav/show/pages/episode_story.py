"""The story of an episode: what was asked and decided, in chapters."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

from hypernav.core.trace import Exchange, Mode, StepTrace, floor_of
from hypernav.show import captions
from hypernav.show.pages.episode_summary import runs
from hypernav.show.video.frame_timing import EVERY_STEP, decisions

_MOST_BARS = 5
_AT_STAIRS_M = 1.0
"""Distance to its destination, metres, from which a robot on stairs was going to these."""
_BLOCK = re.compile(r"^block \d+: ")
"""The number of a block before a reason, which says nothing without the map of that step."""
_CHAPTERS = {
    Mode.LOOK_AROUND: Mode.EXPLORE,
    Mode.RECALL: Mode.EXPLORE,
    Mode.VERIFY: Mode.APPROACH,
    Mode.STOP: Mode.APPROACH,
}
"""Mode by which a chapter goes, where it is not the step's own."""


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
    told = []
    for index, step in enumerate(steps):
        seen = bool(step.events and step.detections)
        asked = tuple(
            _asked_question(e, step) for e in step.exchanges if seen or e.kind not in EVERY_STEP
        )
        if asked or step.events:
            told.append(KeyStep(index, step, asked))
    return told


@dataclass(frozen=True)
class Entry:
    """A step worth telling, and those at which the same was asked again on the way.

    Attributes:
        lead: The step.
        again: The later ones.
    """

    lead: KeyStep
    again: tuple[KeyStep, ...]


def entries(told: Sequence[KeyStep]) -> list[Entry]:
    """The steps worth telling, where nothing but the same question followed, folded into one."""
    found = list[Entry]()
    for moment in told:
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
    told = key_steps(steps)
    found = runs(steps, lambda step: (_CHAPTERS.get(step.mode, step.mode), floor_of(step)))
    return [
        Chapter(
            *what,
            first,
            count,
            tuple(entries([one for one in told if first <= one.index < first + count])),
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
    why, going_to = _BLOCK.sub("", before.reason), before.destination
    if going_to is None or math.dist(going_to, steps[first].pose[:2]) > _AT_STAIRS_M:
        return f"Met on the way to something else: {why}"
    asked = [one for step in steps[:first] for one in decisions(step)]
    if not asked or asked[-1].answer != before.reason:
        return f"Chosen: {why}"
    return f"{captions.answerer_caption(asked[-1])} chose them: {why}"


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
