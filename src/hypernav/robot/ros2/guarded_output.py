"""Commands for the robot, sent on only as long as everything is in order."""

import logging
import threading
import time
from collections.abc import Callable
from typing import Generic, TypeVar

from hypernav.core.errors import HyPerNavError, RosNetworkError

_LOG = logging.getLogger(__name__)
_PERIOD_S = 0.05
VALID_S = 0.3
"""Time for which a command holds; then whoever gave it hangs."""
_STANDS_S = 0.5
"""Time for which standstill is said before silence, so that others may drive."""
_CLOSE_S = 3.0
"""Time for which standstill is said at the end, beyond that for all it takes twice."""
_CommandT = TypeVar("_CommandT")


class GuardedOutput(Generic[_CommandT]):
    """Sends the last command again and again from a thread of its own, or standstill instead.

    Standstill is sent as soon as the data is not fresh any more, or no new command comes: whatever
    the search does, or hangs in. What the network does not take is tried again. Every drive of a
    robot goes through it, whatever its commands are: velocities, or goals of another's navigation.
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
            is_standing: Whether the robot is known to stand; else standstill is said on and on, and
                again when it moves.
            stands_s: Least time for which standstill is said, seconds.
            silence_s: Time after it in which the robot has to stand by itself at the end, seconds:
                as long as a standstill is said, it may only hold the robot.
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
        """Drive by a command from now on, for as long as commands follow.

        After the end only standstill is sent: nobody would watch over another command.
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
        """Stand still, and send nothing any more.

        Raises:
            RosNetworkError: The robot drives all the same, by its odometry, or could not be told.
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
                if silent:  # it was only held; whoever drives it needs to be told for longer
                    self._stands = silent = 0
                is_told = self._is_sent(self._standstill)
                self._stands += is_told
            time.sleep(_PERIOD_S)
        raise RosNetworkError(
            "the robot was told to stand still, and does not stand by its odometry; does "
            "another drive it, or does its body sway (docs/ros2.md)?"
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
        """Say standstill until it was said often enough and the robot stands."""
        if self._is_new or (self._stands >= self._least and self._is_standing()):
            return
        self._stands += self._is_sent(self._standstill)

    def _is_sent(self, command: _CommandT) -> bool:
        """Send a command, and say the first time that it can't be sent."""
        try:
            self._send(command)
        except HyPerNavError as error:  # no transform is no reason to fall silent either
            if not self._fails:
                _LOG.warning("the robot is not told how to drive: %s; trying again", error)
            self._fails = True
            return False
        self._fails = False
        return True
