"""What goes between threads: a worker is given jobs, and a bell says that something is new."""

import asyncio
import queue
import threading
from collections.abc import Callable
from contextlib import ExitStack, suppress

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


class Bell:
    """Wakes everyone who waits for something to become true. Thread-safe."""

    def __init__(self) -> None:
        """Create it; nobody is waiting."""
        self._lock = threading.Lock()
        self._waiting: dict[asyncio.Event, asyncio.AbstractEventLoop] = {}
        self._is_closed = False

    def ring(self) -> None:
        """Let all who wait check their condition again."""
        with self._lock:
            for event, loop in self._waiting.items():
                with suppress(RuntimeError):  # a closed event loop has no waiting coroutines
                    loop.call_soon_threadsafe(event.set)

    def close(self) -> None:
        """End all waiting, now and in future, because the server ends."""
        self._is_closed = True
        self.ring()

    async def until(self, is_so: Callable[[], bool], timeout_s: float | None) -> bool:
        """Wait for a condition, up to a time limit.

        Args:
            is_so: The condition; whoever changes it must ring afterwards.
            timeout_s: Longest wait, seconds; None waits as long as the server lives.

        Returns:
            Whether the condition holds.
        """
        event = asyncio.Event()
        with self._lock:
            self._waiting[event] = asyncio.get_running_loop()
        try:
            async with asyncio.timeout(timeout_s):
                while not (is_so() or self._is_closed):
                    await event.wait()
                    event.clear()
        except TimeoutError:
            pass
        finally:
            with self._lock:
                del self._waiting[event]
        return is_so()
