"""Runs all episodes: gives their lives to workers, and is the only writer of their records.

Lives are assigned to workers with as few loads of scenes as possible. One start of a run is a
session, which is recorded from its start to its end.
"""

import logging
import os
import time
from collections import Counter, deque
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from types import TracebackType
from typing import TYPE_CHECKING

from hypernav.app.show.templating import html_table
from hypernav.core.components.registry import require
from hypernav.core.episode import Episode, Life, Outcome, lives_of
from hypernav.core.errors import (
    ComponentError,
    CrashError,
    HyPerNavError,
    ModelUnavailableError,
    RunFolderError,
)
from hypernav.io.checkout import commit
from hypernav.lab.evaluation.failures import Failure
from hypernav.lab.evaluation.record import EpisodeRecord, unmeasured_record
from hypernav.lab.evaluation.store.run_store import UNENDED, RunStore, Session
from hypernav.lab.evaluation.workers.worker_pool import (
    Crashed,
    Done,
    Lost,
    Ready,
    Refused,
    Report,
    WorkerPool,
    cpu_seconds_of_ended_workers,
)

if TYPE_CHECKING:
    import pandas

ATTEMPTS = 3
"""Number of lost workers after which a life is not tried again."""


class Schedule:
    """Assigns every life once, and the life of a lost worker again.

    A worker keeps to its scene as long as that has lives left. Then it takes the scene with most
    lives among those without a worker, or, if there is none, among all.
    """

    def __init__(self, lives: Iterable[Life]) -> None:
        """Take the lives to run."""
        self._waiting: dict[str, deque[Life]] = {}
        for life in lives:
            self._waiting.setdefault(life.scene_id, deque()).append(life)
        self._scene_of: dict[int, str] = {}
        self._running: dict[int, Life] = {}
        self._losses: Counter[tuple[str, str]] = Counter()

    @property
    def left(self) -> int:
        """Number of unfinished lives, those in flight included."""
        return sum(len(queue) for queue in self._waiting.values()) + len(self._running)

    @property
    def is_finished(self) -> bool:
        """Whether all lives are done."""
        return self.left == 0

    @property
    def has_waiting(self) -> bool:
        """Whether some lives wait for a worker."""
        return any(self._waiting.values())

    def next_for(self, worker: int) -> Life | None:
        """The next life for an idle worker; None if none waits (others may be in flight)."""
        scene = self._scene_for(worker)
        if scene is None:
            return None
        self._scene_of[worker] = scene
        self._running[worker] = self._waiting[scene].popleft()
        return self._running[worker]

    def is_running(self, worker: int) -> bool:
        """Whether a worker has a life in flight."""
        return worker in self._running

    def done(self, worker: int) -> Life:
        """Mark the life of a worker as done, and return it."""
        return self._running.pop(worker)

    def lost(self, worker: int) -> Life | None:
        """Mark a worker as lost.

        Returns:
            Its life if that is not tried again; None if it is, or if the worker was idle.
        """
        self._scene_of.pop(worker, None)
        life = self._running.pop(worker, None)
        if life is None:
            return None
        self._losses[life.key] += 1
        if self._losses[life.key] >= ATTEMPTS:
            return life
        self._waiting[life.scene_id].appendleft(life)
        return None

    def _scene_for(self, worker: int) -> str | None:
        own = self._scene_of.get(worker)
        if own is not None and self._waiting[own]:
            return own
        taken = {scene for other, scene in self._scene_of.items() if other != worker}
        waiting = {scene: len(queue) for scene, queue in self._waiting.items() if queue}
        free = {scene: count for scene, count in waiting.items() if scene not in taken}
        candidates = free or waiting
        # Ties go to the first in the data set, so that the result is deterministic.
        return max(candidates, key=lambda scene: candidates[scene]) if candidates else None


POLL_S = 0.5
"""Period of the calls to ``watch`` while nothing happens, so that clocks on screens advance."""

_CRASHES_IN_A_ROW = 3
_OUTAGES_IN_A_ROW = 3

_LOGGER = logging.getLogger(__name__)


class RunHaltedError(HyPerNavError):
    """A run stopped before its end; finished episodes are safe, and the same command resumes."""


class NothingScoredError(HyPerNavError):
    """No episode of a run counts: its scenes cannot be used, or its workers were lost."""


@dataclass
class RunProgress:
    """The state of a run, for progress displays.

    Attributes:
        records: Records in the order in which they were done, those of earlier sessions first.
        total: Number of all episodes of the run.
        done_now: Number of episodes done in this session.
        peak_mb: Peak memory of each worker, megabytes.
        losses: Number of lost workers.
        crashes: Tracebacks of lives whose worker's program failed; their goals have no record.
        is_own_crash: Whether a component of the user's own failed in the last of them.
    """

    records: list[EpisodeRecord]
    total: int
    done_now: int = 0
    peak_mb: dict[int, float] = field(default_factory=dict)
    losses: int = 0
    crashes: dict[Life, str] = field(default_factory=dict)
    is_own_crash: bool = False

    def to_pandas(self) -> "pandas.DataFrame":
        """A row for every episode, with the fields of `EpisodeRecord`.

        Raises:
            MissingExtraError: pandas is not installed.
        """
        frames = require("pandas", extra="notebook")
        return frames.DataFrame([one.as_row() for one in self.records])

    def _repr_html_(self) -> str:
        shown = ("scene_id", "goal", "outcome", "spl", "steps", "why")
        rows = [{name: one.as_row()[name] for name in shown} for one in self.records]
        return f"<p>{len(rows)} of {self.total} episodes</p>{html_table(rows)}"


def run_episodes(
    episodes: Sequence[Episode],
    store: RunStore,
    pool: WorkerPool,
    *,
    workers: int,
    watch: Callable[[RunProgress], None] | None = None,
) -> RunProgress:
    """Run all lives that the store doesn't hold yet; `begin_again` withdraws parts of them.

    Args:
        episodes: All episodes of the run, the finished ones included.
        store: Store of the run, open.
        pool: Pool without workers; it is closed in any case.
        workers: Maximum number of workers.
        watch: Function that is called with the state of the run when it has changed, and every
            `POLL_S` seconds.

    Returns:
        The state of the run at its end.

    Raises:
        ModelUnavailableError: The model is unavailable in several episodes in a row.
        RunHaltedError: Workers are lost repeatedly, or one reports that the run can't go on.
        CrashError: The program fails repeatedly.
        RunFolderError: The disk is full.
    """
    waiting = [life for life in lives_of(episodes) if not _is_done(life, store)]
    owner = _Owner(Schedule(waiting), store, pool, RunProgress(list(store.records.values()), 0))
    owner.progress.total = len(episodes)
    try:
        owner.start_workers(min(workers, len(waiting)))
        while not owner.schedule.is_finished:
            for report in pool.wait(POLL_S):
                owner.take(report)
            if watch is not None:
                watch(owner.progress)
    finally:
        pool.close()
    return owner.progress


def begin_again(episodes: Sequence[Episode], store: RunStore) -> int:
    """Withdraw the records of lives that are to be run again.

    Those are all with a goal that has no record, after a kill, or one that doesn't count.

    Returns:
        Number of withdrawn records.

    Raises:
        RunFolderError: A record is of an episode that the run doesn't have.
    """
    known = {episode.key for episode in episodes}
    if strange := [key for key in store.records if key not in known]:
        raise RunFolderError(
            f"{store.folder} has records of {len(strange)} episodes that this data set does not "
            f"have, such as {strange[0][1]} in {strange[0][0]}; was the data set or "
            "the folder edited? Choose another --out"
        )
    done = {key for key, record in store.records.items() if record.counts}
    again = {
        episode.key
        for life in lives_of(episodes)
        if not all(one.key in done for one in life.episodes)
        for episode in life.episodes
    }
    return store.withdraw(lambda record: record.key in again or not record.counts)


def _is_done(life: Life, store: RunStore) -> bool:
    return all(episode.key in store.records for episode in life.episodes)


@dataclass
class _Owner:
    """The owner of a run: keeps its state and acts on the reports of workers."""

    schedule: Schedule
    store: RunStore
    pool: WorkerPool
    progress: RunProgress
    workers: int = 0
    outages: int = 0
    crashes: int = 0
    losses: int = 0

    def start_workers(self, workers: int) -> None:
        self.workers = workers
        for worker in range(workers):
            self.pool.start(worker)

    def take(self, report: Report) -> None:
        """Act on the report of one worker."""
        match report:
            case Ready(worker):
                self._give_work(worker)
            case Done(worker, records, peak_mb):
                self.progress.peak_mb[worker] = max(self.progress.peak_mb.get(worker, 0.0), peak_mb)
                self.schedule.done(worker)
                self._keep(records)
                self._give_work(worker)
            case Lost(worker, why):
                _LOGGER.warning("worker %d is lost: %s; another one replaces it", worker, why)
                self._lose(why)
                if (given_up := self.schedule.lost(worker)) is not None:
                    said = f"its worker was lost {ATTEMPTS} times: {why}"
                    self._keep(
                        [
                            unmeasured_record(
                                episode, Outcome.SIMULATOR_ERROR, said, goal_number=number
                            )
                            for number, episode in enumerate(given_up.episodes, start=1)
                        ]
                    )
                self._replace(worker)
            case Crashed(worker):
                self._crash(report)
                self._replace(worker)
            case Refused(_, error):
                raise RunHaltedError(error)

    def _keep(self, records: Sequence[EpisodeRecord]) -> None:
        """Keep the records of a life, whose last one tells of an outage if there was one."""
        for record in records:
            self.store.add(record)
            self.progress.records.append(record)
            self.progress.done_now += 1
        self.crashes = self.losses = 0
        last = records[-1]
        self.outages = self.outages + 1 if last.failure is Failure.MODEL_UNAVAILABLE else 0
        if self.outages >= max(_OUTAGES_IN_A_ROW, 2 * self.workers):
            raise ModelUnavailableError(
                f"the model was not available in {self.outages} episodes in a row ({last.why}); "
                "they are not counted. Bring it back, then run the same command again: it goes on "
                "from here"
            )

    def _lose(self, why: str) -> None:
        self.progress.losses += 1
        self.losses += 1
        if self.losses > ATTEMPTS * max(self.workers, 2):
            raise RunHaltedError(
                f"{self.losses} workers were lost one after the other, the last was {why}; is "
                "there enough memory? Try fewer --workers, then run the same command again"
            )

    def _crash(self, report: Crashed) -> None:
        error, self.progress.is_own_crash = report.error, report.is_own
        if not self.schedule.is_running(report.worker):
            kind = ComponentError if report.is_own else CrashError
            raise kind(f"a worker failed before its first episode: {_last_line(error)}", error)
        life = self.schedule.done(report.worker)
        _LOGGER.error("episode %s failed: %s", "/".join(life.key), _last_line(error))
        self.progress.crashes[life] = error
        self.crashes += 1
        if self.crashes >= _CRASHES_IN_A_ROW:
            raise crash_of(self.progress)

    def _replace(self, worker: int) -> None:
        """Start a new worker for a lost one, if a life waits."""
        if self.schedule.has_waiting:
            self.pool.start(worker)

    def _give_work(self, worker: int) -> None:
        life = self.schedule.next_for(worker)
        if life is not None:
            self.pool.send(worker, life)


def crash_of(progress: RunProgress) -> CrashError | ComponentError:
    """The error that sums up the episodes in which the program or a component failed.

    Args:
        progress: State of a run with at least one such episode.
    """
    crashes = progress.crashes
    life, error = list(crashes.items())[-1]
    several = f"{len(crashes)} episodes, last in " if len(crashes) > 1 else ""
    failed = f"failed in {several}{'/'.join(life.key)}: {_last_line(error)}"
    details = "\n\n".join(f"{'/'.join(one.key)}:\n{error}" for one, error in crashes.items())
    if progress.is_own_crash:
        return ComponentError(f"a component of your own {failed}", details)
    return CrashError(f"the program {failed}", details)


def check_scored(progress: RunProgress) -> None:
    """Make sure that a run has a result: at least one of its episodes counts.

    Raises:
        ModelUnavailableError: None counts, because the model was unavailable.
        NothingScoredError: None counts, for other reasons.
    """
    records = progress.records
    if not records or any(record.counts for record in records):
        return
    away = all(record.failure is Failure.MODEL_UNAVAILABLE for record in records)
    raise (ModelUnavailableError if away else NothingScoredError)(
        f"none of the {len(records)} episodes could be scored ({records[-1].why}); the same "
        "command runs them again"
    )


def _last_line(error: str) -> str:
    return error.rstrip().rpartition("\n")[2] or "no message"


class RunSession:
    """Writes the line of a session when the ``with`` block begins, and completes it at its end.

    Attributes:
        workers: Maximum number of workers.
        progress: Latest state of the run; None before the first.
    """

    def __init__(self, store: RunStore, workers: int) -> None:
        """Create it; the store of the run must be open in the block."""
        self.workers = workers
        self.progress: RunProgress | None = None
        self._store = store
        self._began = time.monotonic()
        self._began_at = datetime.now(UTC).isoformat(timespec="seconds")

    def __enter__(self) -> "RunSession":
        """Write the line."""
        self._write(UNENDED)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Complete the line; after an error, a full disk for example, only if that is possible."""
        try:
            self._write(_ending(error))
        except RunFolderError as unwritable:
            if error is None:
                raise
            _LOGGER.warning("%s", unwritable)

    @property
    def seconds(self) -> float:
        """Time since the start."""
        return time.monotonic() - self._began

    def _write(self, ended: str) -> None:
        progress = self.progress or RunProgress([], 0)
        self._store.write_session(
            Session(
                began=self._began_at,
                commit=commit(),
                ended=ended,
                seconds=round(self.seconds, 1),
                cpu_seconds=cpu_seconds_of_ended_workers(),
                workers=self.workers,
                cores=available_cores(),
                episodes=progress.done_now,
                peak_memory_mb={str(worker): mb for worker, mb in progress.peak_mb.items()},
                workers_lost=progress.losses,
                crashes={"/".join(life.key): error for life, error in progress.crashes.items()},
            )
        )


def available_cores() -> int:
    """Number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _ending(error: BaseException | None) -> str:
    if error is None:
        return "finished"
    if isinstance(error, KeyboardInterrupt):
        return "interrupted"
    first_line = str(error).partition("\n")[0]
    return f"stopped: {first_line or type(error).__name__}"
