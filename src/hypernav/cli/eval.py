"""The command `hypernav eval`: run a whole benchmark so that no interruption loses results."""

import os
import re
import signal
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from types import FrameType
from typing import Any

from rich.console import Console
from rich.live import Live
from rich.markup import escape

from hypernav.build.presets import HyPerNavConfig
from hypernav.cli.eval_options import Options
from hypernav.cli.eval_table import outcome_lines, progress_line, progress_table
from hypernav.core.episode import Episode
from hypernav.core.errors import ConfigError, GoalError
from hypernav.evaluation.run_plan import RunPlan, Selection
from hypernav.evaluation.runner import RunProgress, run_episodes
from hypernav.evaluation.store.run_store import RunStore
from hypernav.evaluation.workers.process_pool import ProcessPool
from hypernav.evaluation.workers.ray_pool import RayPool
from hypernav.evaluation.workers.resource_usage import cpu_seconds_of_ended_workers
from hypernav.evaluation.workers.worker import Job
from hypernav.evaluation.workers.worker_pool import WorkerPool

_LINE_EVERY_S = 60.0


def run(options: Options) -> int:
    """Run the command.

    Returns:
        0 if every episode is done, 1 if some could not be run.
    """
    _check(options)
    console = Console(stderr=True, quiet=options.quiet, highlight=False)
    config = options.who.resolve()
    with console.status("loading the episodes …") as status:
        plan = _plan(options, config)
        episodes = plan.episodes(
            lambda done, total: status.update(f"loading the episodes, {done} of {total} …")
        )
        plan = replace(plan, who=_who(options, config, episodes, console))
    folder = options.out or Path("runs") / _folder_name(f"{options.dataset}-{options.who.agent}")
    with RunStore(folder, plan.configuration(episodes)) as store, _sigterm_as_interrupt():
        if again := store.withdraw(lambda record: not record.counts):
            console.print(f"{again} episodes that don't count are run again")
        if store.records:
            console.print(f"{len(store.records)} of {len(episodes)} episodes are done already")
        pool = _pool(options, folder, config)
        session = _RunSession(store, options.workers or _cores())
        try:
            progress = _watch(console, episodes, store, pool, session)
        except KeyboardInterrupt:
            session.end("interrupted")
            console.print(
                f"interrupted; {len(store.records)} of {len(episodes)} episodes are safe in "
                f"{folder}. Run the same command again to go on",
                soft_wrap=True,
            )
            raise
        session.end("finished")
    for line in outcome_lines(progress, folder):
        console.print(line, soft_wrap=True)
    return 1 if progress.crashes else 0


def _check(options: Options) -> None:
    if options.max_steps < 1:
        raise ConfigError(f"--max-steps {options.max_steps}: a search needs at least one step")
    if options.seed < 0:
        raise ConfigError(f"--seed {options.seed}: a seed is 0 or more")
    if options.success_distance <= 0:
        raise ConfigError(f"--success-distance {options.success_distance}: must be more than 0")
    if options.workers is not None and options.workers < 1:
        raise ConfigError(f"--workers {options.workers}: at least one is needed")
    if options.who.record is not None:
        raise ConfigError(
            "--record is for single searches: use it with hypernav find; an evaluation keeps "
            "questions and answers in the traces of --save videos"
        )


def _plan(options: Options, config: HyPerNavConfig) -> RunPlan:
    return RunPlan(
        dataset=options.dataset,
        selection=Selection(options.episodes, options.scenes, options.goals),
        config=config,
        max_steps=options.max_steps,
        success_distance_m=options.success_distance,
        seed=options.seed,
        scenes_dir=options.scenes_dir,
    )


def _who(
    options: Options, config: HyPerNavConfig, episodes: Sequence[Episode], console: Console
) -> dict[str, Any]:
    """Description of the agent, after checking that it can be built and can see the goals."""
    parts = options.who.build(config)
    if parts.segmenter.warning:
        console.print(f"[yellow]{escape(parts.segmenter.warning)}[/]", soft_wrap=True)
    goals = dict.fromkeys(episode.goal for episode in episodes)
    visible, first_error = [], None
    for goal in goals:
        try:
            parts.check_goal(goal)
            visible.append(goal.text)
        except GoalError as error:
            first_error = first_error or error
    parts.close()
    if first_error is not None:
        raise GoalError(f"{first_error}; choose others: --goals '{','.join(visible)}'")
    return options.who.describe(parts)


def _pool(options: Options, folder: Path, config: HyPerNavConfig) -> WorkerPool:
    job = Job(
        folder=folder,
        config=config,
        seed=options.seed,
        save=options.save,
    )
    return ProcessPool(job) if options.ray is None else RayPool(job, options.ray)


def _watch(
    console: Console,
    episodes: Sequence[Episode],
    store: RunStore,
    pool: WorkerPool,
    session: "_RunSession",
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


@dataclass
class _RunSession:
    """The figures of one start of the program, for ``sessions.jsonl``."""

    store: RunStore
    workers: int
    progress: RunProgress | None = None
    began: float = field(default_factory=time.monotonic)
    began_at: str = field(
        default_factory=lambda: datetime.now(UTC).isoformat(timespec="seconds"), init=False
    )

    @property
    def seconds(self) -> float:
        return time.monotonic() - self.began

    def end(self, how: str) -> None:
        """Write the figures of the session to the store."""
        progress = self.progress
        self.store.add_session(
            {
                "began": self.began_at,
                "ended": how,
                "seconds": round(self.seconds, 1),
                "cpu_seconds": cpu_seconds_of_ended_workers(),
                "workers": self.workers,
                "cores": _cores(),
                "episodes": progress.done_now if progress else 0,
                "peak_memory_mb": (
                    {str(k): v for k, v in progress.peak_mb.items()} if progress else {}
                ),
                "workers_lost": progress.losses if progress else 0,
                "crashes": (
                    {"/".join(spec.key): error for spec, error in progress.crashes.items()}
                    if progress
                    else {}
                ),
            }
        )


@contextmanager
def _sigterm_as_interrupt() -> Iterator[None]:
    """Let SIGTERM end the run as Ctrl-C does."""

    def stop(number: int, frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, stop)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _cores() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _folder_name(text: str) -> str:
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")[:80]
