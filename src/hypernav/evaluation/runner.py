"""Runs all episodes: gives their lives to workers, and is the only writer of their records."""

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from hypernav.core.episode import Episode, Life, Outcome, lives_of
from hypernav.core.errors import ComponentError, CrashError, HyPerNavError, ModelUnavailableError
from hypernav.evaluation.failures.classification import Failure
from hypernav.evaluation.record import EpisodeRecord, unmeasured_record
from hypernav.evaluation.store.run_store import RunStore
from hypernav.evaluation.workers.schedule import ATTEMPTS, Schedule
from hypernav.evaluation.workers.worker_pool import (
    Crashed,
    Done,
    Lost,
    Ready,
    Refused,
    Report,
    WorkerPool,
)

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

    Args:
        episodes: All episodes of the run.
        store: Store of the run, open.

    Returns:
        Number of withdrawn records.
    """
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
