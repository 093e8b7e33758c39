"""`hypernav eval`: run a whole benchmark, and survive everything on the way."""

import os
import re
import signal
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from types import FrameType

import tyro
from rich.console import Console
from rich.live import Live

from hypernav.build.presets import HyPerNavConfig
from hypernav.cli.agent_options import AgentOptions, FlatAgentOptions
from hypernav.cli.eval_table import outcome_lines, progress_line, progress_table
from hypernav.core.errors import ConfigError, GoalError
from hypernav.core.goal import Goal
from hypernav.evaluation.datasets import Episode, load_episodes, select
from hypernav.evaluation.run_plan import RunPlan, Selection
from hypernav.evaluation.runner import RunNews, run_episodes
from hypernav.evaluation.store.run_store import RunStore
from hypernav.evaluation.workers.process_pool import ProcessPool
from hypernav.evaluation.workers.ray_pool import RayPool
from hypernav.evaluation.workers.resource_usage import cpu_seconds_of_ended_workers
from hypernav.evaluation.workers.worker import Job, SaveChoice
from hypernav.evaluation.workers.worker_pool import WorkerPool
from hypernav.worlds.referee import SUCCESS_DISTANCE_M

_LINE_EVERY_S = 60.0


@dataclass(frozen=True)
class Eval:
    """Run the episodes of a benchmark; the same command goes on where it was interrupted."""

    dataset: tyro.conf.Positional[str]
    """houses-val, houses-ovon, houses-train[#FIRST:END] or scene:PATH.glb[#STARTS]."""
    options: FlatAgentOptions = field(default_factory=AgentOptions)
    """Who searches."""
    out: Path | None = None
    """Folder of the run; runs/<dataset>-<agent> by default."""
    episodes: str | None = None
    """Only these, by place in the data set: FIRST:END (END is not included)."""
    scenes: str | None = None
    """Only these scenes, with commas between them: names, house numbers, or places from 0."""
    goals: str | None = None
    """Only these goals, with commas between them."""
    workers: int | None = None
    """Processes, each on one core; all cores by default."""
    ray: str | None = None
    """Run the workers on a Ray cluster instead: its address, or auto."""
    save: SaveChoice = "none"
    """Which episodes keep their page and video."""
    max_steps: int = 500
    """Step limit."""
    success_distance: float = SUCCESS_DISTANCE_M
    """Metres from a view point that count as reached; reports show all others, too."""
    seed: int = 0
    """Of all noise."""
    quiet: bool = False
    """Say nothing but errors."""

    def run(self) -> int:
        """Run the command.

        Returns:
            0 if every episode is done, 1 if some could not be run.
        """
        self._check()
        console = Console(stderr=True, quiet=self.quiet, highlight=False)
        config = self.options.resolve()
        with console.status("loading the episodes …") as status:
            episodes = select(
                load_episodes(
                    self.dataset,
                    config.world,
                    progress=lambda done, total: status.update(
                        f"loading the episodes, {done} of {total} …"
                    ),
                ),
                part=self.episodes,
                scenes=self.scenes,
                goals=self.goals,
            )
            plan = self._plan(config, episodes)
        folder = self.out or Path("runs") / _name(f"{self.dataset}-{self.options.agent}")
        with RunStore(folder, plan.configuration(episodes)) as store, _terminate_gently():
            if again := store.take_out(lambda record: not record.counts):
                console.print(f"{again} episodes that don't count are run again")
            if store.records:
                console.print(f"{len(store.records)} of {len(episodes)} episodes are done already")
            pool = self._pool(self._job(folder, config))
            session = _Session(store, self._workers)
            try:
                news = self._watch(console, episodes, store, pool, session)
            except KeyboardInterrupt:
                session.end("interrupted")
                console.print(
                    f"interrupted; {len(store.records)} of {len(episodes)} episodes are safe in "
                    f"{folder}. Run the same command again to go on",
                    soft_wrap=True,
                )
                raise
            session.end("finished")
        for line in outcome_lines(news, folder):
            console.print(line, soft_wrap=True)
        return 1 if news.crashes else 0

    def _check(self) -> None:
        if self.max_steps < 1:
            raise ConfigError(f"--max-steps {self.max_steps}: a search needs at least one step")
        if self.seed < 0:
            raise ConfigError(f"--seed {self.seed}: a seed is 0 or more")
        if self.success_distance <= 0:
            raise ConfigError(f"--success-distance {self.success_distance}: must be more than 0")
        if self.workers is not None and self.workers < 1:
            raise ConfigError(f"--workers {self.workers}: at least one is needed")
        if self.options.record is not None:
            raise ConfigError(
                "--record is for single searches: use it with hypernav find; an evaluation keeps "
                "questions and answers in the traces of --save videos"
            )

    def _plan(self, config: HyPerNavConfig, episodes: Sequence[Episode]) -> RunPlan:
        """The run, after making sure that its agent can be built and can see the goals."""
        parts = self.options.build(config)
        goals = dict.fromkeys(episode.goal for episode in episodes)
        visible, first_error = [], None
        for goal in goals:
            try:
                parts.check_goal(Goal(goal))
                visible.append(goal)
            except GoalError as error:
                first_error = first_error or error
        parts.close()
        if first_error is not None:
            raise GoalError(f"{first_error}; choose others: --goals '{','.join(visible)}'")
        return RunPlan(
            dataset=self.dataset,
            selection=Selection(self.episodes, self.scenes, self.goals),
            preset=self.options.preset,
            specs=self.options.specs,
            who=self.options.describe(parts),
            config=config,
            max_steps=self.max_steps,
            success_distance_m=self.success_distance,
            seed=self.seed,
        )

    def _job(self, folder: Path, config: HyPerNavConfig) -> Job:
        return Job(
            folder=folder,
            config=config,
            specs=self.options.specs,
            max_steps=self.max_steps,
            success_distance_m=self.success_distance,
            seed=self.seed,
            save=self.save,
        )

    @property
    def _workers(self) -> int:
        return self.workers or _cores()

    def _pool(self, job: Job) -> WorkerPool:
        return ProcessPool(job) if self.ray is None else RayPool(job, self.ray)

    def _watch(
        self,
        console: Console,
        episodes: Sequence[Episode],
        store: RunStore,
        pool: WorkerPool,
        session: "_Session",
    ) -> RunNews:
        """Run it under a live table; where there is no terminal, say a line now and then."""
        live = Live(console=console, refresh_per_second=2, transient=True)
        said = 0.0

        def watch(news: RunNews) -> None:
            nonlocal said
            session.news = news
            if console.is_terminal:
                live.update(progress_table(news, session.seconds))
            elif session.seconds - said >= _LINE_EVERY_S:
                said = session.seconds
                console.print(progress_line(news, session.seconds), soft_wrap=True)

        with live if console.is_terminal else nullcontext():
            return run_episodes(episodes, store, pool, workers=self._workers, watch=watch)


@dataclass
class _Session:
    """One start of the program, for ``sessions.jsonl``."""

    store: RunStore
    workers: int
    news: RunNews | None = None
    began: float = field(default_factory=time.monotonic)
    began_at: str = field(
        default_factory=lambda: datetime.now(UTC).isoformat(timespec="seconds"), init=False
    )

    @property
    def seconds(self) -> float:
        return time.monotonic() - self.began

    def end(self, how: str) -> None:
        """Write the session down."""
        news = self.news
        self.store.note_session(
            {
                "began": self.began_at,
                "ended": how,
                "seconds": round(self.seconds, 1),
                "cpu_seconds": cpu_seconds_of_ended_workers(),
                "workers": self.workers,
                "cores": _cores(),
                "episodes": news.done_now if news else 0,
                "peak_memory_mb": {str(k): v for k, v in news.peak_mb.items()} if news else {},
                "workers_lost": news.losses if news else 0,
                "crashes": (
                    {"/".join(spec.key): error for spec, error in news.crashes.items()}
                    if news
                    else {}
                ),
            }
        )


@contextmanager
def _terminate_gently() -> Iterator[None]:
    """Let a polite `kill` end the run as Ctrl-C does."""

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


def _name(text: str) -> str:
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")[:80]
