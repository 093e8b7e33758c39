"""Runs the exam: asks every question once, several at a time, and resumes after a kill."""

import time
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError

from hypernav.core.errors import OutputError, RunFolderError
from hypernav.lab.evaluation.store.record_file import append_line, file_content, write_whole
from hypernav.lab.evaluation.store.run_store import keep_configuration
from hypernav.lab.exam.bank import Bank, Gather
from hypernav.lab.exam.examinee import Examinee
from hypernav.lab.exam.pictures import write_picture
from hypernav.lab.exam.questions import Answered, ExamQuestion

ANSWERS = "answers.jsonl"
SHEETS = "sheets.jsonl"
FORECAST_AFTER = 10
"""Number of answers from which on there is a forecast."""


@dataclass(frozen=True)
class Progress:
    """State of an exam.

    Attributes:
        done: Number of answers so far, those of earlier sessions included.
        wanted: Number of questions.
        answered_here: Number of answers of this session.
        seconds: Time of this session so far.
        tokens_in: Prompt tokens of all answers.
        tokens_out: Answer tokens of all answers.
    """

    done: int
    wanted: int
    answered_here: int
    seconds: float
    tokens_in: int
    tokens_out: int

    @property
    def left_s(self) -> float | None:
        """Forecast of the time that is left, seconds; None too early."""
        if self.answered_here < FORECAST_AFTER:
            return None
        return self.seconds / self.answered_here * (self.wanted - self.done)

    def cost(self, in_per_million: float | None, out_per_million: float | None) -> float | None:
        """Forecast of the price of the whole exam; None without a price or too early."""
        if self.done < FORECAST_AFTER or (in_per_million is None and out_per_million is None):
            return None
        spent = self.tokens_in * (in_per_million or 0) + self.tokens_out * (out_per_million or 0)
        return spent / 1e6 * self.wanted / self.done


def sit(
    folder: Path,
    bank: Bank,
    gather: Gather,
    examinee: Examinee,
    *,
    configuration: dict[str, Any],
    at_once: int,
    watch: Callable[[Progress], None],
    stop: Callable[[int], None] = lambda _: None,
) -> list[Answered]:
    """Ask all questions that have no answer yet.

    Args:
        folder: Folder of the exam, locked for it; one that was begun is continued.
        bank: The questions.
        gather: Makes the questions of a sheet.
        examinee: Components that are asked.
        configuration: All that the answers depend on; a folder with another one is refused.
        at_once: Number of questions at a time.
        watch: Function that is called after every answer.
        stop: Function that is called when the exam stops before its end, with the number of answers
            under way, which are waited for.

    Returns:
        All answers, in the order of the bank.

    Raises:
        RunFolderError: The folder is of another exam, damaged, or can't be written.
        OutputError: The image of a question can't be written.
        ModelUnavailableError: The model did not answer in time; the answers so far are on the disk.
    """
    with ExitStack() as stack:
        folder.mkdir(parents=True, exist_ok=True)
        keep_configuration(folder, configuration)
        done = {one.id: one for one in read_answers(folder)}
        order: list[str] = []
        began, here = time.monotonic(), 0

        def add(answered: Answered) -> None:
            nonlocal here
            append_line(folder / ANSWERS, answered.model_dump_json())
            done[answered.id] = answered
            here += 1
            tokens = [(e.tokens_in, e.tokens_out) for a in done.values() for e in a.exchanges]
            watch(
                Progress(
                    len(done),
                    bank.count,
                    here,
                    time.monotonic() - began,
                    sum(one for one, _ in tokens),
                    sum(one for _, one in tokens),
                )
            )

        pool = stack.enter_context(ThreadPoolExecutor(at_once))
        running: set[Future[Answered]] = set()
        try:
            for question in _questions(folder, bank, gather, examinee, done, order):
                running.add(pool.submit(_asked, folder, examinee, question))
                # A few wait in line, so that no thread is idle while the next building is made.
                _collect(running, add, at_once + 8)
            _collect(running, add, 0)
        except BaseException:
            stop(sum(one.running() for one in running))
            pool.shutdown(cancel_futures=True)  # keep answers under way: they are paid for
            for one in running:
                if not one.cancelled() and one.exception() is None:
                    add(one.result())
            raise
    return [done[one] for one in order]


def read_answers(folder: Path) -> list[Answered]:
    """All answers of a folder; a last line that a kill cut off is removed.

    Raises:
        RunFolderError: Another line is damaged.
    """
    path = folder / ANSWERS
    answers = []
    lines = _whole_lines(path)
    for number, line in enumerate(lines, 1):
        try:
            answers.append(Answered.model_validate_json(line))
        except ValidationError as error:
            raise RunFolderError(
                f"{path}, line {number} is damaged: remove it, and its question is asked again; "
                "or it is of an earlier version of hypernav: take another --out"
            ) from error
    return answers


def _questions(
    folder: Path,
    bank: Bank,
    gather: Gather,
    examinee: Examinee,
    done: dict[str, Answered],
    order: list[str],
) -> Iterator[ExamQuestion]:
    """The questions without an answer; adds the names of all to `order`, in the bank's order."""
    known = {one.sheet: one.ids for one in _read_sheets(folder)}
    taken = Counter[tuple[Any, str]]()
    for sheet in bank.sheets():
        if sum(taken.values()) >= bank.count:
            return
        ids = known.get(sheet.number)
        if ids is None or any(one not in done for one in ids):
            found = gather(sheet)
            can_name = {id(one): examinee.can_name(one) for one in found}
            chosen = bank.choose([one for one in found if can_name[id(one)]], taken)
            if ids is None:
                ids = [one.id for one in chosen]
                boxes = [one for one in found if one.kind == "boxes"]
                nameless = Counter(one.goal.text for one in boxes if not can_name[id(one)])
                line = _SheetLine(
                    sheet=sheet.number, ids=ids, boxes=len(boxes), nameless=dict(nameless)
                )
                append_line(folder / SHEETS, line.model_dump_json())
            yield from (one for one in chosen if one.id not in done)
        order += ids
        taken.update((one.split("/")[2], one.split("/")[3]) for one in ids)


class _SheetLine(BaseModel):
    """What was taken from a sheet: a line of `SHEETS`."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    sheet: int
    ids: list[str]
    boxes: int = 0
    nameless: dict[str, int] = {}


def _read_sheets(folder: Path) -> list[_SheetLine]:
    try:
        return [_SheetLine.model_validate_json(line) for line in _whole_lines(folder / SHEETS)]
    except ValidationError as error:
        raise RunFolderError(
            f"{folder / SHEETS} is damaged; remove it, and the questions are made again"
        ) from error


@dataclass(frozen=True)
class Nameless:
    """Questions for boxes that a detector of a closed list was not asked, having no name for it.

    Attributes:
        share: Their share of all questions for boxes of the sheets, 0 to 1.
        goals: What they are about, the most frequent first.
    """

    share: float = 0.0
    goals: tuple[str, ...] = ()

    @property
    def words(self) -> str:
        """A sentence about them; empty if there are none."""
        if not self.goals:
            return ""
        some = ", ".join(self.goals[:5]) + (" …" if len(self.goals) > 5 else "")
        return (
            f"{self.share:.0%} of the bank's questions for boxes were left out, since the detector "
            f"has no name for the goal ({len(self.goals)} kinds of goals: {some})."
        )


def nameless_of(folder: Path) -> Nameless:
    """The questions that an exam's detector could not be asked.

    Raises:
        RunFolderError: The folder is damaged.
    """
    sheets = _read_sheets(folder)
    goals = Counter[str]()
    for one in sheets:
        goals.update(one.nameless)
    boxes = sum(one.boxes for one in sheets)
    order = tuple(goal for goal, _ in goals.most_common())
    return Nameless(goals.total() / boxes if boxes else 0.0, order)


def _asked(folder: Path, examinee: Examinee, question: ExamQuestion) -> Answered:
    answered = examinee.ask(question)
    try:
        write_picture(folder, question, answered)
    except OSError as error:
        raise OutputError(f"{folder} cannot be written ({error.strerror or error})") from error
    return answered


def _collect(running: set[Future[Answered]], add: Callable[[Answered], None], most: int) -> None:
    """Wait until no more than so many questions are under way, and keep the answers."""
    while True:
        for one in [one for one in running if one.done()]:
            running.remove(one)
            add(one.result())
        if len(running) <= most:
            return
        wait(running, return_when=FIRST_COMPLETED)


def _whole_lines(path: Path) -> list[bytes]:
    """The lines of a file; a last one that a kill cut off is removed from it."""
    content = file_content(path)
    end = content.rfind(b"\n") + 1
    if end < len(content):
        write_whole(path, content[:end])
    return content[:end].splitlines()
