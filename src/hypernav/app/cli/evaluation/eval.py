"""The command `hypernav eval`: run a whole benchmark so that no interruption loses results.

While it runs, a table shows the progress; a summary ends it.
"""

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import nullcontext
from pathlib import Path

from rich.console import Console
from rich.live import Live
from rich.markup import escape
from rich.table import Table

from hypernav.app.build.components.choosing import choose_components
from hypernav.app.build.components.exam_file import read_exam
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.app.cli.evaluation.run_choice import check, config_of, planned, worker_count
from hypernav.app.cli.guards.crashes import ExitStatus, crash_report
from hypernav.app.cli.guards.outputs import check_folder
from hypernav.app.cli.options.commands import EvalOptions
from hypernav.app.cli.screen.search_lines import unusable_answers_line, warnings_on
from hypernav.app.cli.screen.terminal import Terminal
from hypernav.core.episode import Episode, lives_of
from hypernav.core.errors import ConfigError
from hypernav.core.naming.words import number_of
from hypernav.lab.evaluation.failures import Failure
from hypernav.lab.evaluation.run_cost import (
    cost_by_episodes,
    cost_by_exam,
    cost_lines,
    kinds_asked,
    pace_words,
)
from hypernav.lab.evaluation.runner import (
    RunProgress,
    RunSession,
    begin_again,
    check_scored,
    crash_of,
    run_episodes,
)
from hypernav.lab.evaluation.statistics import (
    DRAWS,
    Estimate,
    counted,
    drawn,
    failure_counts,
    interval,
    percent,
    summarise,
)
from hypernav.lab.evaluation.store.run_store import RUN_FILES, RunStore
from hypernav.lab.evaluation.store.scene_files import SCENES_FILE, keep_scenes
from hypernav.lab.evaluation.workers.job import Job
from hypernav.lab.evaluation.workers.process_pool import ProcessPool
from hypernav.lab.evaluation.workers.ray_pool import RayPool
from hypernav.lab.evaluation.workers.worker_pool import WorkerPool
from hypernav.search.models.chat.vlm_spec import open_chat, parse_vlm_spec

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
    buildings = number_of(len({one.scene_id for one in progress.records}), "building")
    yield f"{len(progress.records)} of {progress.total} episodes done, in {buildings}"
    if progress.records:
        for name, value, remark in _numbers(progress, is_over=True):
            yield f"  {name:9s} {value}  {remark}".rstrip()
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
    words = f"({{}} to {{}}{unit} with 95 % confidence, over {over})"
    return interval(estimate, factor, words) if over else ""


_LINE_EVERY_S = 60.0
_PLANNED_BY = 10
"""Least number of episodes by which a run without an exam is planned."""


def run(options: EvalOptions) -> int:
    """Run the command.

    Returns:
        The status of success: every episode is done.

    Raises:
        HyPerNavError: The run cannot be started, stopped before its end, or has no result.
        ReportedCrashError: The program failed in some of the episodes.
    """
    check(options)
    folder = options.out or Path("runs") / folder_name(f"{options.dataset}-{options.who.name}")
    check_folder(folder, (*RUN_FILES, SCENES_FILE))
    console = Terminal(quiet=options.quiet)
    with crash_report(folder):
        if options.plan and options.who.exam is not None:
            _say_cost_by_exam(options, options.who.exam, console)
            return ExitStatus.SUCCESS
        progress = evaluate(options, folder, console)
        for line in outcome_lines(progress, folder):
            console.print(line, soft_wrap=True)
        if options.plan and progress.records:
            _say_cost_by_episodes(options, progress, console)
        if progress.crashes:
            raise crash_of(progress)
        check_scored(progress)
    return ExitStatus.SUCCESS


def evaluate(
    options: EvalOptions, folder: Path, console: Terminal, *, heading: str = ""
) -> RunProgress:
    """Load the episodes, and run those that aren't done.

    Args:
        options: All options but the folder.
        folder: Folder of the run.
        console: Terminal that shows the progress.
        heading: Line to print when the run begins; empty for none.

    Returns:
        The state of the run at its end.

    Raises:
        HyPerNavError: The run cannot be started, or stopped before its end.
    """
    with warnings_on(console):
        plan, episodes = planned(options, console)
        if options.plan:
            _say_pace(options, plan.config, len(episodes), console)
    with RunStore(folder, plan.configuration(episodes)) as store:
        if heading:
            console.print(heading)
        if again := begin_again(episodes, store):
            console.print(f"{again} episodes that don't count are run again")
        with console.status("looking at the files of the scenes …") as status:
            keep_scenes(
                store,
                episodes,
                lambda done, total: status.update(f"reading the scenes, {done} of {total} …"),
            )
        if store.records:
            console.print(f"{len(store.records)} of {len(episodes)} episodes are done already")
        pool = _pool(options, folder, plan.config)
        session = RunSession(store, worker_count(options))
        now = _first_lives(episodes) if options.plan else episodes
        try:
            with session, warnings_on(console):
                progress = _watch(console, now, store, pool, session)
                progress.total = len(episodes)
                return progress
        except KeyboardInterrupt:
            console.print(
                f"interrupted; {len(store.records)} of {len(episodes)} episodes are safe in "
                f"{folder}. Run the same command again to go on",
                soft_wrap=True,
            )
            raise


def _first_lives(episodes: Sequence[Episode]) -> list[Episode]:
    """The episodes by which a run is planned: those of whole lives."""
    first = list[Episode]()
    for life in lives_of(episodes):
        if len(first) >= _PLANNED_BY:
            break
        first += life.episodes
    return first


def _say_pace(options: EvalOptions, config: HyPerNavConfig, count: int, console: Console) -> None:
    """Say how long searches take by one answer of a server, before any of them."""
    # Imported here: only a plan asks a model.
    from hypernav.lab.evaluation.checks.vlm_checkup import grounding_answer

    vlm = options.who.vlm
    kinds = kinds_asked(choose_components(options.who.specs, presence=config.presence.enabled))
    if vlm is None or parse_vlm_spec(vlm).kind != "openai" or not kinds:
        return
    with console.status("asking the model …"):
        answer = grounding_answer(open_chat(vlm, config.chat), config.grounding)
    said = pace_words(answer.seconds, config, kinds)
    console.print(f"{said}; this run has {count} searches", markup=False, soft_wrap=True)


def _say_cost_by_exam(options: EvalOptions, exam: Path, console: Console) -> None:
    """Say what the run costs, and run nothing."""
    who = options.who
    if who.agent != "hypernav":
        raise ConfigError(
            f"--plan: an exam predicts searches of --agent hypernav, not of {who.agent}; without "
            "--exam the first ten episodes tell"
        )
    plan, episodes = planned(options, console)
    kinds = kinds_asked(choose_components(who.specs, presence=plan.config.presence.enabled))
    cost = cost_by_exam(read_exam(exam), who.preset, plan.config, kinds)
    for line in cost_lines(cost, len(episodes), worker_count(options), plan.config):
        console.print(line, soft_wrap=True)


def _say_cost_by_episodes(options: EvalOptions, progress: RunProgress, console: Console) -> None:
    config = config_of(options)
    kinds = kinds_asked(choose_components(options.who.specs, presence=config.presence.enabled))
    cost = cost_by_episodes(progress.records, config, kinds)
    console.print(f"by these {len(progress.records)} episodes:")
    for line in cost_lines(cost, progress.total, worker_count(options), config):
        console.print(line, soft_wrap=True)


def _pool(options: EvalOptions, folder: Path, config: HyPerNavConfig) -> WorkerPool:
    job = Job(
        folder=folder,
        config=config,
        specs=options.who.specs,
        seed=options.seed,
        save=options.save,
        world=options.world,
        fresh_memory=options.fresh_memory,
    )
    return ProcessPool(job) if options.ray is None else RayPool(job, options.ray)


def _watch(
    console: Console,
    episodes: Sequence[Episode],
    store: RunStore,
    pool: WorkerPool,
    session: RunSession,
) -> RunProgress:
    """Run the episodes under a live table, or, without a terminal, with a line every minute."""
    live = Live(console=console, refresh_per_second=2, transient=True)
    said = 0.0

    def watch(progress: RunProgress) -> None:
        nonlocal said
        session.progress = progress
        if console.is_terminal:
            live.update(progress_table(progress, session.seconds))
        elif session.seconds - said >= _LINE_EVERY_S:
            said = session.seconds
            console.print(progress_line(progress, session.seconds), soft_wrap=True)

    with live if console.is_terminal else nullcontext():
        return run_episodes(episodes, store, pool, workers=session.workers, watch=watch)


def folder_name(text: str) -> str:
    """A text as the name of a folder."""
    return re.sub(r"[\W_]+", "-", text.lower()).strip("-")[:60]
