"""The moment at which something that waits for others has to be over."""

import time
from collections.abc import Callable


class Deadline:
    """A moment that everything done for one purpose shares, however many waits it takes.

    Attributes:
        limit_s: Time from the beginning to the deadline, seconds.
    """

    def __init__(self, limit_s: float, clock: Callable[[], float] = time.monotonic) -> None:
        """Begin now.

        Args:
            limit_s: Time until the deadline, seconds.
            clock: Function that returns monotonic seconds.
        """
        self.limit_s = limit_s
        self._clock = clock
        self._end = clock() + limit_s

    @property
    def seconds_left(self) -> float:
        """Time until the deadline; 0 once it has passed."""
        return max(self._end - self._clock(), 0.0)

    def timeout(self) -> float:
        """Time until the deadline, as the timeout of the next wait.

        Raises:
            TimeoutError: The deadline has passed.
        """
        left = self.seconds_left
        if left <= 0.0:
            raise TimeoutError(f"not done within {self.limit_s:.3g} s")
        return left

    def within(self, limit_s: float) -> "Deadline":
        """The sooner of this deadline and a new one that begins now."""
        return Deadline(min(limit_s, self.seconds_left), self._clock)
