"""A bell that threads ring and coroutines wait for."""

import asyncio
import threading
from collections.abc import Callable
from contextlib import suppress


class Bell:
    """Wakes everyone who waits for something to become true. Thread-safe."""

    def __init__(self) -> None:
        """Begin with nobody waiting."""
        self._lock = threading.Lock()
        self._waiting: dict[asyncio.Event, asyncio.AbstractEventLoop] = {}

    def ring(self) -> None:
        """Let all who wait look again."""
        with self._lock:
            for event, loop in self._waiting.items():
                with suppress(RuntimeError):  # a loop that was closed waits for nothing
                    loop.call_soon_threadsafe(event.set)

    async def until(self, is_so: Callable[[], bool], timeout_s: float) -> bool:
        """Wait until something is so, for a while.

        Args:
            is_so: What is waited for; whoever changes it rings afterwards.
            timeout_s: Longest wait, seconds.

        Returns:
            Whether it is so.
        """
        event = asyncio.Event()
        with self._lock:
            self._waiting[event] = asyncio.get_running_loop()
        try:
            async with asyncio.timeout(timeout_s):
                while not is_so():
                    await event.wait()
                    event.clear()
        except TimeoutError:
            pass
        finally:
            with self._lock:
                del self._waiting[event]
        return is_so()
