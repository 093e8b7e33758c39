"""Waits until DDS has discovered the readers and publishers of others."""

import time
from collections.abc import Callable

from hypernav.core.errors import Nav2Error

_LOOK_S = 0.1


def wait_for(missing: Callable[[], str | None], timeout_s: float) -> None:
    """Wait until nothing is missing.

    Args:
        missing: What is missing, in words that say what to do about it; None if nothing is.
        timeout_s: Longest wait, seconds.

    Raises:
        Nav2Error: Something is still missing; the message is that of `missing`.
    """
    until_s = time.monotonic() + timeout_s
    while (words := missing()) is not None:
        if time.monotonic() > until_s:
            raise Nav2Error(words)
        time.sleep(_LOOK_S)
