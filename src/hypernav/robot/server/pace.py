"""How fast a server answers, so that a robot is refused before all of them wait too long."""

import threading
import time
from collections import deque
from collections.abc import Callable
from statistics import median

from hypernav.core.trace import StepTrace

_WINDOW_S = 10.0
_LEAST = 20
"""Number of answers in the window from which on it says something."""


class Pace:
    """The time that the answers of the last seconds took, that of chat models left out.

    A model's server is somebody else's, and waiting for it takes none of this server's time.
    Thread-safe.
    """

    def __init__(self, now_s: Callable[[], float] = time.monotonic) -> None:
        """Begin without answers.

        Args:
            now_s: Clock, seconds.
        """
        self._now_s = now_s
        self._lock = threading.Lock()
        self._answers: deque[tuple[float, float]] = deque()

    def note(self, trace: StepTrace | None, offered_s: float) -> None:
        """Count an answer that was given just now.

        Args:
            trace: The decision; None if nothing had to be decided.
            offered_s: Time at which its observation had come, on the clock.
        """
        asked = [] if trace is None else trace.exchanges
        models_s = sum(one.seconds for one in asked if one.by_model)
        now_s = self._now_s()
        with self._lock:
            self._answers.append((now_s, now_s - offered_s - models_s))
            self._forget(now_s)

    def median_s(self) -> float | None:
        """Median of the answers of the last seconds; None if they are too few to judge."""
        with self._lock:
            self._forget(self._now_s())
            if len(self._answers) < _LEAST:
                return None
            return median(took_s for _, took_s in self._answers)

    def _forget(self, now_s: float) -> None:
        while self._answers and self._answers[0][0] < now_s - _WINDOW_S:
            self._answers.popleft()
