"""Ctrl-C, SIGTERM and a lost terminal: one kind of interruption, which a block can put off."""

import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from types import FrameType, TracebackType
from typing import NoReturn, TypeVar

_EnteredT = TypeVar("_EnteredT")
_ENDINGS = tuple(one for one in signal.Signals if one.name in ("SIGTERM", "SIGHUP"))
"""Signals to end; SIGHUP, which Windows doesn't have, comes when the terminal is gone, as an SSH
connection over Wi-Fi is."""


class Terminated(KeyboardInterrupt):
    """SIGTERM or SIGHUP came: it ends whatever Ctrl-C ends, and by the same path."""


@contextmanager
def sigterm_as_interruption() -> Iterator[None]:
    """Raise `Terminated` in the block when SIGTERM or, unless ``nohup`` is set, SIGHUP comes."""
    with _handled(_ENDINGS, _terminate):
        yield


@contextmanager
def interruptions_put_off(notice: str | None = None) -> Iterator[None]:
    """Let the block finish: an interruption that comes meanwhile is raised at its end.

    Args:
        notice: What to tell people when one comes, on standard error.
    """
    came: list[int] = []

    def note(number: int, _frame: FrameType | None) -> None:
        came.append(number)
        if notice is not None:
            with suppress(OSError):  # Past `sys.stderr`, in the midst of whose writing it may be.
                os.write(2, f"\nhypernav: {notice}\n".encode())

    with _handled((signal.SIGINT, *_ENDINGS), note):
        yield
    if came:
        signal.raise_signal(came[0])


class UninterruptedEnd(AbstractContextManager[_EnteredT, bool | None]):
    """A context whose end no interruption cuts short, such as that of a robot that must stand."""

    def __init__(
        self, context: AbstractContextManager[_EnteredT, bool | None], notice: str | None = None
    ) -> None:
        """Wrap a context that nobody has entered yet.

        Args:
            context: The context.
            notice: What to tell people when an interruption has to wait for its end.
        """
        self._context, self._notice = context, notice

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
        with interruptions_put_off(self._notice):
            return self._context.__exit__(kind, error, traceback)


def interrupt() -> None:
    """End the command as Ctrl-C does, from any thread."""
    signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)


@contextmanager
def _handled(
    numbers: tuple[signal.Signals, ...], handler: Callable[[int, FrameType | None], None]
) -> Iterator[None]:
    """Handle signals in the block, but for SIGHUP where it is ignored, as ``nohup`` has it."""
    before = {
        number: signal.signal(number, handler)
        for number in numbers
        if number.name != "SIGHUP" or signal.getsignal(number) is not signal.SIG_IGN
    }
    try:
        yield
    finally:
        for number, earlier in before.items():
            signal.signal(number, earlier)


def _terminate(_number: int, _frame: FrameType | None) -> NoReturn:
    raise Terminated
