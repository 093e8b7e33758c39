"""What workers are to the one who owns a run, wherever they are."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from hypernav.core.episode import Episode
from hypernav.evaluation.record import EpisodeRecord


@dataclass(frozen=True)
class Ready:
    """A worker that was hired can take its first episode.

    Attributes:
        worker: Which.
    """

    worker: int


@dataclass(frozen=True)
class Done:
    """A worker has finished its episode.

    Attributes:
        worker: Which.
        record: What came of the episode.
        peak_mb: The most memory that the worker has used up to now.
    """

    worker: int
    record: EpisodeRecord
    peak_mb: float


@dataclass(frozen=True)
class Lost:
    """A worker is gone: killed, out of memory, its machine switched off.

    Attributes:
        worker: Which.
        why: In words.
    """

    worker: int
    why: str


@dataclass(frozen=True)
class Crashed:
    """The program of a worker failed: a bug, not bad luck; the worker is gone.

    Attributes:
        worker: Which.
        error: Its traceback.
    """

    worker: int
    error: str


@dataclass(frozen=True)
class Refused:
    """A worker says that the run can't go on like this (no model file, disk full, …).

    Attributes:
        worker: Which.
        error: In words.
    """

    worker: int
    error: str


Report = Ready | Done | Lost | Crashed | Refused


@runtime_checkable
class WorkerPool(Protocol):
    """Workers. Each runs one episode at a time; results come back through `wait` alone."""

    def start(self, worker: int) -> None:
        """Hire a worker of this number, or another one for a lost one; `wait` says: ready."""
        ...

    def send(self, worker: int, episode: Episode) -> None:
        """Give a ready worker an episode. That it is gone will be reported by `wait`."""
        ...

    def wait(self, seconds: float) -> list[Report]:
        """What has happened; waits for something to happen, but no longer than this."""
        ...

    def close(self) -> None:
        """Dismiss everyone at once, whatever they are doing."""
        ...
