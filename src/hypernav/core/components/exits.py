"""What `os._exit` does while a component of a user's own is at work: nothing ends unsaid.

It would end the process without a word, and with a status that the component chooses; 0 means that
the goal was found.
"""

import os
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import NoReturn

end_at_once = os._exit
"""`os._exit` as the system has it, for this package."""

_at_work = threading.local()


@contextmanager
def exits_raised() -> Iterator[None]:
    """In the block, `os._exit` raises `SystemExit`, as `sys.exit` does.

    Processes that a component forks in it end as they wish, and so do other threads.
    """
    if os._exit is end_at_once:
        os._exit = _raise_or_end
    before = getattr(_at_work, "process", None)
    _at_work.process = os.getpid()
    try:
        yield
    finally:
        _at_work.process = before


def answer_exits(answer: Callable[[int], NoReturn]) -> None:
    """Let a function answer each `os._exit` of this process outside such a block.

    Args:
        answer: Takes the status that was asked for, and ends the process.
    """
    owner = os.getpid()

    def end(status: int) -> NoReturn:
        if os.getpid() == owner:
            answer(status)
        end_at_once(status)

    os._exit = lambda status: _raise_or_end(status, end)


def _raise_or_end(status: int, end: Callable[[int], NoReturn] = end_at_once) -> NoReturn:
    if getattr(_at_work, "process", None) == os.getpid():
        raise SystemExit(f"os._exit({status})")
    end(status)
