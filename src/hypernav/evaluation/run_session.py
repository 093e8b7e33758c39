"""Records one session of a run, from its start to its end."""

import logging
import os
import time
from datetime import UTC, datetime
from types import TracebackType

from hypernav.core.errors import RunFolderError
from hypernav.evaluation.runner import RunProgress
from hypernav.evaluation.store.run_store import RunStore
from hypernav.evaluation.store.session import UNENDED, Session
from hypernav.evaluation.workers.resource_usage import cpu_seconds_of_ended_workers

_LOGGER = logging.getLogger(__name__)


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
