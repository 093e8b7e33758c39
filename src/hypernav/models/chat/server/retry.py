"""Bounded retries with exponential backoff; only for errors that may be temporary."""

import logging
import time
from collections import Counter
from collections.abc import Callable
from typing import TypeVar

from hypernav.core.errors import ChatTimeoutError, ChatTransportError, ModelUnavailableError
from hypernav.core.network.bounded_http import Deadline
from hypernav.models.chat.config import ChatConfig

_Result = TypeVar("_Result")
_log = logging.getLogger(__name__)
_LEAST_S = 0.001
"""Time that must be left for another attempt, seconds: waits add up with rounding errors."""


class RetryLaterError(ChatTransportError):
    """A server that is reachable but cannot answer now; it may say how long to wait.

    Attributes:
        wait_s: Wait that the server asks for; None if it does not say.
        status: HTTP status code.
    """

    def __init__(
        self, message: str, wait_s: float | None = None, *, status: int = 503, remedy: str = ""
    ) -> None:
        """Store wait and status with the message."""
        super().__init__(message, remedy=remedy)
        self.wait_s = wait_s
        self.status = status


class Retry:
    """Repeats lost or timed-out attempts until one succeeds or ``patience_s`` has passed.

    Of the waits between attempts the first is ``first_wait_s`` and each is twice the one before,
    up to ``longest_wait_s``.
    """

    def __init__(
        self,
        config: ChatConfig,
        *,
        sleep: Callable[[float], None] = time.sleep,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Prepare.

        Args:
            config: Timeouts, waits and ``patience_s``.
            sleep: Function that waits for a number of seconds.
            clock: Function that returns monotonic seconds.
        """
        self._config = config
        self._sleep = sleep
        self._clock = clock

    def begin(self) -> Deadline:
        """The deadline for a question that is asked now."""
        return Deadline(self._config.patience_s, self._clock)

    def call(
        self, attempt: Callable[[Deadline], _Result], *, who: str, patience: Deadline
    ) -> tuple[_Result, Counter[str]]:
        """Attempt until one succeeds.

        Args:
            attempt: Function of one attempt; takes the moment at which it has to be over.
            who: Name of the server, for messages.
            patience: Result of `begin`; all that belongs to one question shares it.

        Returns:
            The result, and how many attempts before it were lost to "transport" and "timeout".

        Raises:
            ModelUnavailableError: No attempt succeeded within ``patience_s``. Where the last one
                ended without a word, its message has the last words of the server besides.
        """
        config = self._config
        wait = config.first_wait_s
        lost: Counter[str] = Counter()
        told: ChatTransportError | None = None
        while True:
            left = patience.seconds_left if config.patience_s > 0.0 else config.timeout_s
            try:
                return attempt(Deadline(min(config.timeout_s, left), self._clock)), lost
            except (ChatTransportError, ChatTimeoutError) as error:
                lost["timeout" if isinstance(error, ChatTimeoutError) else "transport"] += 1
                told = error if isinstance(error, ChatTransportError) else told
                asked_for = error.wait_s if isinstance(error, RetryLaterError) else None
                # A server may ask for a longer wait than ours, never for a shorter one.
                pause = min(max(wait, asked_for or 0.0), config.longest_wait_s)
                if pause + _LEAST_S >= patience.seconds_left:
                    attempts = lost.total()
                    times = f"{attempts} {'attempt' if attempts == 1 else 'attempts'}"
                    if config.patience_s > 0.0:
                        times += f" within a patience of {config.patience_s:g} s"
                    before = "" if told in (None, error) else f"; before that: {told}"
                    unavailable = ModelUnavailableError(
                        f"{who} gave no answer in {times}; last: {error}{before}"
                    )
                    # The message has it already.
                    unavailable.remedy = error.remedy or (told.remedy if told else "")
                    raise unavailable from error
                _log.warning(
                    "%s; asking again in %.1f s (attempt %d)", error, pause, lost.total() + 1
                )
                self._sleep(pause)
                wait = min(wait * 2.0, config.longest_wait_s)
