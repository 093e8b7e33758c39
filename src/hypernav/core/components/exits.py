"""What ends a process while a component of a user's own, or compiled code, is at work.

`os._exit` and `os.exec…` would end or replace the process without a word, and with a status that
the component chooses; 0 means that the goal was found.
"""

import os
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from typing import Any, NoReturn

end_at_once = os._exit
"""`os._exit` as the system has it, for this package."""

_ENDING: dict[str, Callable[..., Any]] = {
    name: getattr(os, name) for name in ("_exit", "execv", "execve")
}
"""What ends or replaces this process. `os.execl` and others call the last two."""
_answers: dict[int, Callable[[str], NoReturn]] = {}
"""What answers them outside a component's call, by process: one that is forked ends as it likes."""
_at_work = threading.local()


@contextmanager
def exits_raised() -> Iterator[None]:
    """In the block, `os._exit` and `os.exec…` raise `SystemExit`, as `sys.exit` does.

    Processes that a component forks in it end as they wish, and so do other threads.
    """
    _install()
    before = getattr(_at_work, "process", None)
    _at_work.process = os.getpid()
    try:
        yield
    finally:
        _at_work.process = before


def answer_exits(answer: Callable[[str], NoReturn]) -> None:
    """Let a function answer each `os._exit` and `os.exec…` of this process outside such a block.

    Args:
        answer: Takes the call in words, such as ``os._exit(0)``, and ends the process.
    """
    _install()
    _answers[os.getpid()] = answer


def _install() -> None:
    for name, real in _ENDING.items():
        if getattr(os, name) is real:
            setattr(os, name, _answered(name, real))


def _answered(name: str, real: Callable[..., Any]) -> Callable[..., Any]:
    @wraps(real)
    def end(*given: Any, **named: Any) -> Any:
        called = f"os.{name}({', '.join(map(repr, given[:1]))}{', …' if given[1:] else ''})"
        if getattr(_at_work, "process", None) == os.getpid():
            raise SystemExit(called)
        if os.getpid() in _answers:
            _answers[os.getpid()](called)
        return real(*given, **named)

    end.__module__ = os.__name__  # so that it can be pickled, as the real one can
    return end


@contextmanager
def interruptions_of_kernels() -> Iterator[None]:
    """Raise an interruption in the block unchanged, even if a compiled function was running.

    If a signal handler raises while a numba function returns, Python finds both a result and an
    error, and raises `SystemError` with the interruption as its cause.

    Raises:
        KeyboardInterrupt: Ctrl-C or SIGTERM came.
        SystemExit: A signal came that ends the process.
    """
    try:
        yield
    except SystemError as error:
        cause = error.__cause__
        while isinstance(cause, SystemError):
            cause = cause.__cause__
        if isinstance(cause, KeyboardInterrupt | SystemExit):
            raise cause from None
        raise
