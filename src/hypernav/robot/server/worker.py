"""A thread that does one job after the other and does not delay the program's end."""

import queue
import threading
from collections.abc import Callable
from contextlib import ExitStack

Job = Callable[[], object]


class Worker:
    """One thread for one search, so that no robot waits for another.

    Compiled kernels, image decoding and questions to a model all release Python's lock. The thread
    is a daemon: a model that does not answer cannot keep the server from ending, and a search that
    is cut off is resumed as after a crash. A job that raises ends the thread, and Python prints
    its traceback on standard error (`threading.excepthook`).
    """

    def __init__(self, name: str, on_failure: Job) -> None:
        """Start the thread.

        Args:
            name: Name of the thread, for people.
            on_failure: Function to call in the thread if a job raises: no other job will be done.
        """
        self._on_failure = on_failure
        self._jobs: queue.SimpleQueue[Job | None] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._work, name=name, daemon=True)
        self._thread.start()

    def submit(self, job: Job) -> None:
        """Add a job."""
        self._jobs.put(job)

    def end(self) -> None:
        """Let the thread end after its present jobs."""
        self._jobs.put(None)

    def join(self, timeout_s: float) -> None:
        """Wait until the thread has ended, up to a time limit."""
        self._thread.join(timeout_s)

    def _work(self) -> None:
        with ExitStack() as failed:
            failed.callback(self._on_failure)
            while (job := self._jobs.get()) is not None:
                job()
            failed.pop_all()
