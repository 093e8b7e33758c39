"""One owner runs all episodes: hands them to workers and alone writes what comes back."""

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from hypernav.core.episode import Episode
from hypernav.core.errors import HyPerNavError
from hypernav.evaluation.failures.classification import Failure
from hypernav.evaluation.record import EpisodeRecord
from hypernav.evaluation.store.run_store import RunStore
from hypernav.evaluation.workers.schedule import ATTEMPTS, Schedule
from hypernav.evaluation.workers.worker import broken
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
"""How often somebody is told that nothing has happened, so that clocks on screens go on."""

_CRASHES_IN_A_ROW = 3
_OUTAGES_IN_A_ROW = 3

_LOGGER = logging.getLogger(__name__)


class RunHaltedError(HyPerNavError):
    """A run stopped before its end; what was done is safe, and the same command goes on."""


@dataclass
class RunNews:
    """What happens in a run, for those who watch it.

    Attributes:
        records: What is done, in the order in which it was done, earlier sessions first.
        total: Episodes in all.
        done_now: Episodes done in this session.
        peak_mb: Most memory that each worker has used.
        losses: Workers that were lost.
        crashes: Episodes whose worker's program failed, with the traceback; they have no record.
    """

    records: list[EpisodeRecord]
    total: int
    done_now: int = 0
    peak_mb: dict[int, float] = field(default_factory=dict)
    losses: int = 0
    crashes: dict[Episode, str] = field(default_factory=dict)


def run_episodes(
    episodes: Sequence[Episode],
    store: RunStore,
    pool: WorkerPool,
    *,
    workers: int,
    watch: Callable[[RunNews], None] | None = None,
) -> RunNews:
    """Run all episodes that the store doesn't hold yet.

    Args:
        episodes: All of the run, the finished ones included.
        store: Open.
        pool: Nobody needs to be hired yet. It is closed in any case.
        workers: How many to hire at most.
        watch: Is told whenever something has happened, and from time to time.

    Raises:
        RunHaltedError: The model is away, or the program fails again and again.
        RunFolderError: The disk is full.
        HyPerNavError: A worker said that the run can't go on.
    """
    waiting = [episode for episode in episodes if episode.key not in store.records]
    owner = _Owner(Schedule(waiting), store, pool, RunNews(list(store.records.values()), 0))
    owner.news.total = len(episodes)
    try:
        owner.hire(min(workers, len(waiting)))
        while not owner.schedule.is_finished:
            for report in pool.wait(POLL_S):
                owner.take(report)
            if watch is not None:
                watch(owner.news)
    finally:
        pool.close()
    return owner.news


@dataclass
class _Owner:
    """The state of a run."""

    schedule: Schedule
    store: RunStore
    pool: WorkerPool
    news: RunNews
    workers: int = 0
    outages: int = 0
    crashes: int = 0
    losses: int = 0

    def hire(self, workers: int) -> None:
        self.workers = workers
        for worker in range(workers):
            self.pool.start(worker)

    def take(self, report: Report) -> None:
        """Deal with what happened to one worker."""
        match report:
            case Ready(worker):
                self._give_work(worker)
            case Done(worker, record, peak_mb):
                self.news.peak_mb[worker] = max(self.news.peak_mb.get(worker, 0.0), peak_mb)
                self.schedule.done(worker)
                self._keep(record)
                self._give_work(worker)
            case Lost(worker, why):
                _LOGGER.warning("worker %d is lost: %s; another takes its place", worker, why)
                self._lose(why)
                if (given_up := self.schedule.lost(worker)) is not None:
                    self._keep(broken(given_up, f"its worker was lost {ATTEMPTS} times: {why}"))
                self._replace(worker)
            case Crashed(worker, error):
                self._crash(worker, error)
                self._replace(worker)
            case Refused(_, error):
                raise RunHaltedError(error)

    def _keep(self, record: EpisodeRecord) -> None:
        self.store.add(record)
        self.news.records.append(record)
        self.news.done_now += 1
        self.crashes = self.losses = 0
        self.outages = self.outages + 1 if record.failure is Failure.MODEL_UNAVAILABLE else 0
        if self.outages >= max(_OUTAGES_IN_A_ROW, 2 * self.workers):
            raise RunHaltedError(
                f"the model was not available in {self.outages} episodes in a row ({record.why}); "
                "they are not counted. Bring it back, then run the same command again: it goes on "
                "from here"
            )

    def _lose(self, why: str) -> None:
        self.news.losses += 1
        self.losses += 1
        if self.losses > ATTEMPTS * max(self.workers, 2):
            raise RunHaltedError(
                f"{self.losses} workers were lost one after the other, the last was {why}; is "
                "there enough memory? Try fewer --workers, then run the same command again"
            )

    def _crash(self, worker: int, error: str) -> None:
        if not self.schedule.is_running(worker):
            raise RunHaltedError(f"a worker failed before its first episode:\n{error}")
        episode = self.schedule.done(worker)
        _LOGGER.error("episode %s failed:\n%s", "/".join(episode.key), error)
        self.news.crashes[episode] = error
        self.crashes += 1
        if self.crashes >= _CRASHES_IN_A_ROW:
            raise RunHaltedError(
                f"the program failed in {self.crashes} episodes in a row, last in "
                f"{'/'.join(episode.key)}:\n{error}"
            )

    def _replace(self, worker: int) -> None:
        """Hire a new worker for a lost one, if anything waits."""
        if self.schedule.has_waiting:
            self.pool.start(worker)

    def _give_work(self, worker: int) -> None:
        episode = self.schedule.next_for(worker)
        if episode is not None:
            self.pool.send(worker, episode)
