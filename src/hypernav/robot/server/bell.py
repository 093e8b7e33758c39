"""A bell that threads ring and coroutines wait for."""

import asyncio
import threading
from collections.abc import Callable
from contextlib import suppress


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
