"""Ctrl-C and SIGTERM: one kind of interruption, which a block can put off."""

import signal
import threading
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from types import FrameType, TracebackType
from typing import NoReturn, TypeVar

_EnteredT = TypeVar("_EnteredT")


class Terminated(KeyboardInterrupt):
    """SIGTERM came: it ends whatever Ctrl-C ends, and by the same path."""


@contextmanager
def sigterm_as_interruption() -> Iterator[None]:
    """Raise `Terminated` in the block when SIGTERM comes."""
    before = signal.signal(signal.SIGTERM, _terminate)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


@contextmanager
def interruptions_put_off() -> Iterator[None]:
    """Let the block finish: an interruption that comes meanwhile is raised at its end."""
    came: list[int] = []

    def note(number: int, _frame: FrameType | None) -> None:
        came.append(number)

    before = {number: signal.signal(number, note) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    if came:
        signal.raise_signal(came[0])


class EndedInPeace(AbstractContextManager[_EnteredT, bool | None]):
    """A context whose end no interruption cuts short, such as that of a robot that must stand."""

    def __init__(self, context: AbstractContextManager[_EnteredT, bool | None]) -> None:
        """Wrap a context that nobody has entered yet."""
        self._context = context

    def __enter__(self) -> _EnteredT:
        """Enter it."""
        return self._context.__enter__()

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> bool | None:
        """Leave it; an interruption that comes meanwhile is raised then."""
        with interruptions_put_off():
            return self._context.__exit__(kind, error, traceback)


def interrupt() -> None:
    """End the command as Ctrl-C does, from any thread."""
    signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)


def _terminate(_number: int, _frame: FrameType | None) -> NoReturn:
    raise Terminated
