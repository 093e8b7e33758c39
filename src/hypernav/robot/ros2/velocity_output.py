"""Velocities for the robot, sent on only as long as everything is in order."""

import logging
import threading
import time
from collections.abc import Callable

from hypernav.core.errors import RosNetworkError
from hypernav.robot.motion.velocity import STANDSTILL, Velocity

_LOG = logging.getLogger(__name__)
_PERIOD_S = 0.05
VALID_S = 0.3
"""Time for which a command holds; then whoever gave it hangs."""
_STANDS = 10
"""Number of times that standstill is said before silence, so that others may drive."""


class VelocityOutput:
    """Sends the last command again and again from a thread of its own, or standstill instead.

    Standstill is sent as soon as the data is not fresh any more, or no new command comes: whatever
    the search does, or hangs in. What the network does not take is tried again.
    """

    def __init__(self, send: Callable[[Velocity], None], is_safe: Callable[[], bool]) -> None:
        """Begin at a standstill.

        Args:
            send: Function that sends a velocity to the robot.
            is_safe: Whether the robot may drive now.
        """
        self._send = send
        self._is_safe = is_safe
        self._lock = threading.Lock()
        self._command, self._commanded_s, self._stands = STANDSTILL, 0.0, _STANDS
        self._fails = False
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, name="velocity", daemon=True)
        self._thread.start()

    def command(self, velocity: Velocity) -> None:
        """Drive with a velocity from now on, for as long as commands follow."""
        with self._lock:
            self._command, self._commanded_s = velocity, time.monotonic()
            self._stands = 0
            self._tick()

    def close(self) -> None:
        """Stand still, and send nothing any more; a standstill that can't be sent is logged."""
        self.command(STANDSTILL)
        self._ended.set()
        self._thread.join()
        for _ in range(_STANDS):
            if self._is_sent(STANDSTILL):
                return
            time.sleep(_PERIOD_S)
        _LOG.error("the robot could not be told to stand still; it stops if its base does so alone")

    def _run(self) -> None:
        while not self._ended.wait(_PERIOD_S):
            with self._lock:
                self._tick()

    def _tick(self) -> None:
        is_late = time.monotonic() - self._commanded_s > VALID_S
        if self._command.is_zero or is_late or not self._is_safe():
            if self._stands >= _STANDS:
                return
            self._stands += self._is_sent(STANDSTILL)
        else:
            self._stands = 0
            self._is_sent(self._command)

    def _is_sent(self, velocity: Velocity) -> bool:
        """Send a velocity, and say the first time that it can't be sent."""
        try:
            self._send(velocity)
        except RosNetworkError as error:
            if not self._fails:
                _LOG.warning("the robot is told no velocity: %s; trying again", error)
            self._fails = True
            return False
        self._fails = False
        return True
