"""The protocol of worker pools, the reports that they give, and what workers use."""

import sys
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from hypernav.core.episode import Life
from hypernav.lab.evaluation.record import EpisodeRecord


def peak_memory_mb() -> float:
    """Peak resident memory of this process, megabytes; 0 if the system doesn't provide it."""
    if sys.platform == "win32":
        return 0.0
    import resource

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    unit = 1024 if sys.platform == "linux" else 1
    return round(peak * unit / 1e6, 1)


def cpu_seconds_of_ended_workers() -> float:
    """Processor time of all ended child processes; 0 if the system doesn't provide it."""
    if sys.platform == "win32":
        return 0.0
    import resource

    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return round(used.ru_utime + used.ru_stime, 1)


@dataclass(frozen=True)
class Ready:
    """A started worker can take its first life.

    Attributes:
        worker: Number of the worker.
    """

    worker: int


@dataclass(frozen=True)
class Done:
    """A worker has finished its life.

    Attributes:
        worker: Number of the worker.
        records: Records of all its goals.
        peak_mb: Peak memory of the worker up to now, megabytes.
    """

    worker: int
    records: list[EpisodeRecord]
    peak_mb: float


@dataclass(frozen=True)
class Lost:
    """A worker is lost: killed, out of memory, its machine switched off.

    Attributes:
        worker: Number of the worker.
        why: Reason in words.
    """

    worker: int
    why: str


@dataclass(frozen=True)
class Crashed:
    """The program of a worker failed by a bug; the worker has ended.

    Attributes:
        worker: Number of the worker.
        error: Traceback of the failure; its last line says what failed.
        is_own: Whether a component of the user's own failed, not this package.
    """

    worker: int
    error: str
    is_own: bool = False


@dataclass(frozen=True)
class Refused:
    """A worker reports that the run can't go on (no model file, disk full, …).

    Attributes:
        worker: Number of the worker.
        error: Message of the error.
    """

    worker: int
    error: str


Report = Ready | Done | Lost | Crashed | Refused


@runtime_checkable
class WorkerPool(Protocol):
    """A pool of workers, each running one life at a time; `wait` returns their reports."""

    def start(self, worker: int) -> None:
        """Start a worker with a new number or that of a lost one; `wait` reports it `Ready`."""
        ...

    def send(self, worker: int, life: Life) -> None:
        """Send an idle worker a life; `wait` reports it `Lost` if it has ended."""
        ...

    def wait(self, seconds: float) -> list[Report]:
        """The reports since the last call; waits for one, up to a time limit."""
        ...

    def close(self) -> None:
        """End all workers at once, whatever they are doing."""
        ...
