"""Waiting for those who take what is published."""

import time
from typing import Protocol

from hypernav.core.errors import Nav2Error

_LOOK_S = 0.1


class HasReader(Protocol):
    """A publisher that knows of its readers."""

    def has_reader(self) -> bool:
        """Whether somebody takes the messages, in their type."""
        ...


def await_reader(publisher: HasReader, timeout_s: float, otherwise: str) -> None:
    """Wait until somebody takes what is published.

    Args:
        publisher: What nobody may take yet: DDS needs a while to find readers.
        timeout_s: Longest wait, seconds.
        otherwise: What to say if nobody does.

    Raises:
        Nav2Error: Nobody does.
    """
    until_s = time.monotonic() + timeout_s
    while not publisher.has_reader():
        if time.monotonic() > until_s:
            raise Nav2Error(otherwise)
        time.sleep(_LOOK_S)
