"""The progress table of `hypernav eval`, and the summary at its end."""

from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path

from rich.markup import escape
from rich.table import Table

from hypernav.cli.screen.warnings_shown import unusable_answers_line
from hypernav.evaluation.failures import Failure
from hypernav.evaluation.report.report_text import interval, percent
from hypernav.evaluation.runner import RunProgress
from hypernav.evaluation.statistics import (
    DRAWS,
    Estimate,
    counted,
    drawn,
    failure_counts,
    summarise,
)

_MOST_REASONS = 3
"""Largest number of reasons that are printed for episodes that don't count or didn't run."""


def progress_table(progress: RunProgress, seconds: float) -> Table:
    """Episodes done, rate, time left, success, model calls and failures.

    Args:
        progress: State of the run.
        seconds: Time since this session began.
    """
    done, rate = len(progress.records), progress.done_now / max(seconds, 1e-9)
    left = f"{duration((progress.total - done) / rate)} left" if rate > 0.0 else "starting …"
    table = Table(show_header=False, box=None, padding=(0, 2, 0, 0))
    table.add_row("done", f"{done} of {progress.total}", f"{3600 * rate:.0f} an hour, {left}")
    if done:
        for row in _numbers(progress, is_over=False):
            table.add_row(*row)
    if progress.losses:
        table.add_row("workers", f"{progress.losses} lost", "others took their place")
    if progress.crashes:
        table.add_row("[red]errors[/]", str(len(progress.crashes)), "episodes could not be run")
    return table


def progress_line(progress: RunProgress, seconds: float) -> str:
    """The progress in one line, for log files."""
    done, rate = len(progress.records), progress.done_now / max(seconds, 1e-9)
    text = f"{done} of {progress.total} episodes, {3600 * rate:.0f} an hour"
    return f"{text}, {_rates(progress)}" if done else text


def result_line(progress: RunProgress) -> str:
    """The result of a run in one line."""
    done = len(progress.records)
    text = f"{done} of {progress.total} episodes done"
    return f"{text}, {_rates(progress)}" if done else text


def _rates(progress: RunProgress) -> str:
    if not counted(progress.records):
        return "none of them counts"
    summary = summarise(progress.records, draws=1)
    return f"SR {100 * summary.success.mean:.1f} %, SPL {summary.spl.mean:.3f}"


def outcome_lines(progress: RunProgress, folder: Path) -> Iterator[str]:
    """The summary of a run, in lines."""
    yield f"{len(progress.records)} of {progress.total} episodes done"
    if progress.records:
        for name, value, remark in _numbers(progress, is_over=True):
            yield f"  {name:9s} {value}  {remark}"
    unusable = sum((Counter(one.unusable_answers) for one in progress.records), Counter[str]())
    if line := unusable_answers_line(_calls(progress), unusable):
        yield line
    apart = dict.fromkeys(record.why for record in progress.records if not record.counts)
    for why in list(apart)[:_MOST_REASONS]:
        yield f"  [red]doesn't count[/]: {escape(why)}"
    for life, error in list(progress.crashes.items())[:_MOST_REASONS]:
        last = error.splitlines()[-1] if error else "no message"
        yield f"  [red]not run[/]: {escape('/'.join(life.key))}: {escape(last)}"
    yield f"  results in {escape(str(folder / 'episodes.jsonl'))}"
    yield f"  page: hypernav report {escape(str(folder))}"


def _numbers(progress: RunProgress, *, is_over: bool) -> Iterator[tuple[str, str, str]]:
    """Names, values and remarks; with intervals, which take a moment, once the run is over."""
    if records := counted(progress.records):
        summary = summarise(records, draws=DRAWS if is_over else 1)
        over = drawn(record.scene_id for record in records) if is_over else ""
        yield "SR", percent(summary.success), _interval(summary.success, over, 100.0, " %")
        yield "SPL", f"{summary.spl.mean:.3f}", _interval(summary.spl, over)
        yield "steps", f"{summary.steps.mean:.0f}", "a mean episode"
    calls = _calls(progress)
    if calls:
        yield "models", str(calls), f"calls, {calls / len(progress.records):.1f} an episode"
    counts = failure_counts(progress.records)
    if counts:
        yield "failures", str(sum(counts.values())), words_of(counts)


def _calls(progress: RunProgress) -> int:
    return sum(record.model_calls for record in progress.records)


def words_of(counts: Mapping[Failure, int]) -> str:
    """Failure classes with their numbers, most frequent first."""
    ranked = sorted(counts.items(), key=lambda item: -item[1])
    return ", ".join(f"{count} {failure.words}" for failure, count in ranked)


def duration(seconds: float) -> str:
    """A duration for people: "2 h 05 min", "7 min", "40 s"."""
    if seconds >= 3600:
        return f"{int(seconds // 3600)} h {int(seconds % 3600 // 60):02d} min"
    return f"{int(seconds // 60)} min" if seconds >= 60 else f"{seconds:.0f} s"


def _interval(estimate: Estimate, over: str, factor: float = 1.0, unit: str = "") -> str:
    if not over:
        return ""
    return f"({interval(estimate, factor)}{unit} with 95 % confidence, over {over})"
