"""Sends commands to the robot only while its data is fresh and the search is alive."""

import logging
import threading
import time
from collections.abc import Callable
from typing import Generic, TypeVar

from hypernav.core.errors import HyPerNavError, RosNetworkError

_LOG = logging.getLogger(__name__)

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


_PERIOD_S = 0.05
VALID_S = 0.3
"""Time for which a command stays in force; without a new one its sender is taken to hang."""
_STANDS_S = 0.5
"""Time for which standstill is sent before falling silent, so that others may drive."""
_CLOSE_S = 3.0
"""Additional time for which standstill is sent at the end."""
_CommandT = TypeVar("_CommandT")


class GuardedOutput(Generic[_CommandT]):
    """Sends the last command repeatedly from a thread of its own, or standstill instead.

    Standstill is sent as soon as the data is no longer fresh or no new command comes, even if the
    search hangs. A message that the network refuses is sent again. Every drive uses this class,
    whether its commands are velocities or goals for Nav2.
    """

    def __init__(
        self,
        send: Callable[[_CommandT], None],
        standstill: _CommandT,
        *,
        is_safe: Callable[[], bool],
        is_standing: Callable[[], bool] = lambda: True,
        stands_s: float = _STANDS_S,
        silence_s: float = 0.0,
    ) -> None:
        """Begin at a standstill.

        Args:
            send: Function that sends a command to the robot, 20 times a second.
            standstill: The command to stand still.
            is_safe: Whether the robot may drive now.
            is_standing: Whether the robot is known to stand still; until then, and when it moves
                again, standstill is sent.
            stands_s: Shortest time for which standstill is sent, seconds.
            silence_s: Time at the end, without messages, in which the robot must stand still,
                seconds: while standstill is sent, it may only be held.
        """
        self._send, self._standstill = send, standstill
        self._is_safe, self._is_standing = is_safe, is_standing
        self._lock = threading.Lock()
        self._command, self._commanded_s = standstill, 0.0
        self._least, self._silence = round(stands_s / _PERIOD_S), round(silence_s / _PERIOD_S)
        self._stands, self._is_new, self._fails = 0, True, False
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, name="drive", daemon=True)
        self._thread.start()

    def command(self, command: _CommandT) -> None:
        """Use a command from now on, as long as new commands keep coming.

        After `close` only standstill is sent, because commands are no longer supervised.
        """
        if self._ended.is_set() and command != self._standstill:
            return
        with self._lock:
            self._command, self._commanded_s = command, time.monotonic()
            self._stands, self._is_new = 0, False
            self._tick()

    def halt(self) -> None:
        """Stand still."""
        self.command(self._standstill)

    def close(self) -> None:
        """Stand still, then stop sending.

        Raises:
            RosNetworkError: Odometry shows that the robot still moves, or sending failed.
        """
        self.halt()
        self._ended.set()
        self._thread.join()
        is_told, silent = False, 0
        for _ in range(2 * (self._least + self._silence) + round(_CLOSE_S / _PERIOD_S)):
            if self._stands >= self._least and self._is_standing():
                if silent >= self._silence:
                    return
                silent += 1
            else:
                if silent:  # it was only held: tell its driver for longer
                    self._stands = silent = 0
                is_told = self._is_sent(self._standstill)
                self._stands += is_told
            time.sleep(_PERIOD_S)
        raise RosNetworkError(
            "the robot was told to stand still, but its odometry shows motion; does "
            "another program drive it, or does its body sway (docs/ros2.md)?"
            if is_told
            else "the robot could not be told to stand still; it stops if its base does so alone"
        )

    def _run(self) -> None:
        while not self._ended.wait(_PERIOD_S):
            with self._lock:
                self._tick()

    def _tick(self) -> None:
        is_late = time.monotonic() - self._commanded_s > VALID_S
        if self._command == self._standstill or is_late or not self._is_safe():
            self._stand()
        else:
            self._stands = 0
            self._is_sent(self._command)

    def _stand(self) -> None:
        """Send standstill until it was sent long enough and the robot stands still."""
        if self._is_new or (self._stands >= self._least and self._is_standing()):
            return
        self._stands += self._is_sent(self._standstill)

    def _is_sent(self, command: _CommandT) -> bool:
        """Send a command; log the first failure."""
        try:
            self._send(command)
        except HyPerNavError as error:  # a missing transform must not end the messages either
            if not self._fails:
                _LOG.warning("the robot is not told how to drive: %s; trying again", error)
            self._fails = True
            return False
        self._fails = False
        return True
