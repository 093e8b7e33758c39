"""The watchdog: a robot whose answer is late stands still."""

import threading
from collections.abc import Callable
from types import TracebackType
from typing import Protocol, runtime_checkable


@runtime_checkable
class Timer(Protocol):
    """Calls a function later, unless it is cancelled; `threading.Timer` is one."""

    def start(self) -> None:
        """Begin to wait."""
        ...

    def cancel(self) -> None:
        """Call nothing."""
        ...


class Watchdog:
    """Calls a function if a ``with`` block takes too long, while the block goes on.

    The function runs in a thread of its own, so that a block that waits for the network, or hangs,
    can't keep it from running.

    Attributes:
        times_late: Number of blocks so far that took too long.

    Example:
        >>> with Watchdog(0.5, robot.stop):  # doctest: +SKIP
        ...     reply = link.ask(body, sequence, timeout_s=5.0)
    """

    def __init__(
        self,
        deadline_s: float,
        on_late: Callable[[], None],
        *,
        timer: Callable[[float, Callable[[], None]], Timer] = threading.Timer,
    ) -> None:
        """Create it.

        Args:
            deadline_s: Time after which it acts, seconds.
            on_late: Function to call, for example `hypernav.robot.client.robot.Robot.stop`.
            timer: Maker of timers.
        """
        self._deadline_s = deadline_s
        self._on_late = on_late
        self._make_timer = timer
        self._timer: Timer | None = None
        self._lock = threading.Lock()
        self._watches = False
        self.times_late = 0

    def __enter__(self) -> "Watchdog":
        """Begin to wait."""
        self._watches = True
        self._timer = self._make_timer(self._deadline_s, self._act)
        if isinstance(self._timer, threading.Timer):
            self._timer.daemon = True
        self._timer.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """End the waiting; after this it does not act any more."""
        if self._timer is not None:
            self._timer.cancel()
        with self._lock:  # Whatever acts now must not stop the motion that comes next.
            self._watches = False

    def _act(self) -> None:
        with self._lock:
            if self._watches:
                self.times_late += 1
                self._on_late()
