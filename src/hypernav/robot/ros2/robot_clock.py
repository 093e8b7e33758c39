"""The clock of a robot, as the stamps of its messages tell it."""

import time
from collections.abc import Callable

NTP_DRIFT = 5e-4
"""Largest rate at which two clocks drift apart: that by which NTP corrects one."""


class RobotClock:
    """Estimates how old a message is, although the clocks of the two machines may differ.

    The message that came fastest so far gives the offset of the robot's clock from ours; a message
    that takes longer is late. If the robot's clock is slower than the drift allows, as that of a
    simulator below real time, its messages seem to get older and older.
    """

    def __init__(
        self, drift: float = NTP_DRIFT, *, clock: Callable[[], float] = time.monotonic
    ) -> None:
        """Begin without messages.

        Args:
            drift: Largest share of time by which the robot's clock may run slower than ours.
            clock: Clock of this machine.
        """
        self._drift, self._clock = drift, clock
        self._behind_s: float | None = None
        self._heard_s = 0.0

    def hear(self, stamp_s: float) -> None:
        """Note the stamp of a message that arrives now."""
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
