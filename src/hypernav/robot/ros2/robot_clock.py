"""The clock of a robot, as the stamps of its messages tell it."""

import time
from collections.abc import Callable

NTP_DRIFT = 5e-4
"""Largest rate at which two clocks drift apart: that by which NTP corrects one."""


class RobotClock:
    """Tells how old a message is, also where the network delays all of them alike.

    The message that came fastest so far tells how far the robot's clock is from ours; one that
    takes longer is late. The messages of a robot whose clock loses more than the drift, as that of
    a simulator slower than real time does, grow old.
    """

    def __init__(
        self, drift: float = NTP_DRIFT, *, clock: Callable[[], float] = time.monotonic
    ) -> None:
        """Begin without messages.

        Args:
            drift: Largest share of time that the robot's clock loses on ours.
            clock: Clock of this machine.
        """
        self._drift, self._clock = drift, clock
        self._behind_s: float | None = None
        self._heard_s = 0.0

    def hear(self, stamp_s: float) -> None:
        """Take the time of a message that arrives now."""
        now_s = self._clock()
        behind_s = now_s - stamp_s
        if self._behind_s is not None:
            behind_s = min(behind_s, self._behind_s + self._drift * (now_s - self._heard_s))
        self._behind_s, self._heard_s = behind_s, now_s

    @property
    def now_s(self) -> float:
        """The present time on the robot's clock, seconds; infinite before the first message."""
        return float("inf") if self._behind_s is None else self._clock() - self._behind_s

    def age_s(self, stamp_s: float) -> float:
        """Time since a message was stamped, seconds; infinite before the first message."""
        return self.now_s - stamp_s
