"""The progress table of `hypernav eval`, and the summary at its end."""

from collections.abc import Iterator, Mapping
from pathlib import Path

from rich.table import Table

from hypernav.evaluation.failures.classification import Failure
from hypernav.evaluation.runner import RunNews
from hypernav.evaluation.statistics import Estimate
from hypernav.evaluation.summary import failure_counts, summarise

_LIVE_DRAWS = 1000


def progress_table(news: RunNews, seconds: float) -> Table:
    """Episodes done, rate, time left, success, model calls and failures.

    Args:
        news: State of the run.
        seconds: Time since this session began.
    """
    done, rate = len(news.records), news.done_now / max(seconds, 1e-9)
    left = f"{duration((news.total - done) / rate)} left" if rate > 0.0 else "starting …"
    table = Table(show_header=False, box=None, padding=(0, 2, 0, 0))
    table.add_row("done", f"{done} of {news.total}", f"{3600 * rate:.0f} an hour, {left}")
    if done:
        for row in _numbers(news):
            table.add_row(*row)
    if news.losses:
        table.add_row("workers", f"{news.losses} lost", "others took their place")
    if news.crashes:
        table.add_row("[red]errors[/]", str(len(news.crashes)), "episodes could not be run")
    return table


def progress_line(news: RunNews, seconds: float) -> str:
    """The progress in one line, for log files."""
    done, rate = len(news.records), news.done_now / max(seconds, 1e-9)
    text = f"{done} of {news.total} episodes, {3600 * rate:.0f} an hour"
    if done:
        summary = summarise(news.records, draws=1)
        text += f", SR {100 * summary.success.mean:.1f} %, SPL {summary.spl.mean:.3f}"
    return text


def outcome_lines(news: RunNews, folder: Path) -> Iterator[str]:
    """The lines that sum up a run at its end."""
    yield f"{len(news.records)} of {news.total} episodes done"
    if news.records:
        for name, value, remark in _numbers(news):
            yield f"  {name:9s} {value}  {remark}"
    for episode, error in list(news.crashes.items())[:3]:
        last = error.splitlines()[-1] if error else "no message"
        yield f"  [red]not run[/]: {'/'.join(episode.key)}: {last}"
    yield f"  results in {folder / 'episodes.jsonl'}"
    yield f"  page: hypernav report {folder}"


def _numbers(news: RunNews) -> Iterator[tuple[str, str, str]]:
    summary = summarise(news.records, draws=_LIVE_DRAWS)
    yield "SR", _percent(summary.success), _interval(summary.success)
    yield "SPL", f"{summary.spl.mean:.3f}", _interval(summary.spl, percent=False)
    calls = sum(record.model_calls for record in news.records)
    yield "steps", f"{summary.steps.mean:.0f}", "a mean episode"
    if calls:
        yield "models", str(calls), f"calls, {calls / len(news.records):.1f} an episode"
    counts = failure_counts(news.records)
    if counts:
        yield "failures", str(sum(counts.values())), words_of(counts)


def words_of(counts: Mapping[Failure, int]) -> str:
    """Failure classes with their numbers, most frequent first."""
    ranked = sorted(counts.items(), key=lambda item: -item[1])
    return ", ".join(f"{count} {failure.words}" for failure, count in ranked)


def duration(seconds: float) -> str:
    """A duration for people: "2 h 05 min", "7 min", "40 s"."""
    if seconds >= 3600:
        return f"{int(seconds // 3600)} h {int(seconds % 3600 // 60):02d} min"
    return f"{int(seconds // 60)} min" if seconds >= 60 else f"{seconds:.0f} s"


def _percent(estimate: Estimate) -> str:
    return f"{100 * estimate.mean:.1f} %"


def _interval(estimate: Estimate, *, percent: bool = True) -> str:
    low, high = estimate.low, estimate.high
    text = f"{100 * low:.1f} to {100 * high:.1f} %" if percent else f"{low:.3f} to {high:.3f}"
    return f"({text} with 95 % confidence)"
