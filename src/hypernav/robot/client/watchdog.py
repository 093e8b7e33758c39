"""The watchdog: a robot whose answer is late stands still."""

import threading
from collections.abc import Callable

from hypernav.robot.client.side_thread import SideThread


class Watchdog(SideThread):
    """Calls a function if a ``with`` block takes too long, while the block goes on.

    The function has returned before the block ends, so it cannot stop the motion that comes next.

    Attributes:
        times_late: Number of blocks that took too long.

    Examples:
        >>> with Watchdog(0.5, robot.stop):  # doctest: +SKIP
        ...     reply = link.ask(body, sequence, timeout_s=5.0)
    """

    def __init__(
        self,
        deadline_s: float,
        on_late: Callable[[], None],
        *,
        wait: Callable[[threading.Event, float], bool] = threading.Event.wait,
    ) -> None:
        """Create it.

        Args:
            deadline_s: Time after which it acts, seconds.
            on_late: Function to call, for example `hypernav.robot.client.robot.Robot.stop`.
            wait: Function that waits some seconds for an event, and says whether it came.
        """
        self._deadline_s = deadline_s
        self._on_late = on_late
        self._wait = wait
        self.times_late: int = 0

    def _work_until(self, block_ended: threading.Event) -> None:
        if not self._wait(block_ended, self._deadline_s):
            self.times_late += 1
            self._on_late()
