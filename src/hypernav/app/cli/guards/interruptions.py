"""Ctrl-C, SIGTERM and a lost terminal, treated as one interruption that a block can delay."""

import math
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from types import FrameType, TracebackType
from typing import TypeVar

_EnteredT = TypeVar("_EnteredT")
_ENDINGS = tuple(one for one in signal.Signals if one.name in ("SIGTERM", "SIGHUP"))
"""Signals that end a command. SIGHUP, which Windows doesn't have, comes when the terminal is lost,
for example with an SSH connection."""
_INSISTING_S = 5.0
"""Time within which a second interruption ends the process, whoever caught the first."""
_SAME_S = 0.3
"""Time within which a second one is the same: ``timeout`` signals a process and then its group."""
_AGAIN_S = 0.05
"""Time after which an interruption that could not be raised is sent again."""
_last_s = [-math.inf]
"""When an interruption was raised that nobody has answered by `interruptions_put_off` yet."""


class Terminated(KeyboardInterrupt):
    """SIGTERM or SIGHUP came; handled like Ctrl-C."""


@contextmanager
def sigterm_as_interruption() -> Iterator[None]:
    """Raise `Terminated` in the block when SIGTERM or, unless ``nohup`` is set, SIGHUP comes.

    A component of a user's own may catch that, or Ctrl-C, and go on. A second one within 5 s ends
    the process, unless `interruptions_put_off` has begun: results are being written then.
    """
    _last_s[0] = -math.inf
    with _raised_again(), _handled((signal.SIGINT, *_ENDINGS), _raise_or_end):
        yield


@contextmanager
def interruptions_put_off(notice: str | None = None) -> Iterator[None]:
    """Let the block finish: an interruption during it is raised at its end.

    Args:
        notice: Text for standard error when one comes.
    """
    came: list[int] = []

    def note(number: int, _frame: FrameType | None) -> None:
        came.append(number)
        if notice is not None:
            with suppress(OSError):  # Not by `sys.stderr`, which may be in the middle of a write.
                os.write(2, f"\nhypernav: {notice}\n".encode())

    _last_s[0] = -math.inf  # whoever is here has heard it
    with _handled((signal.SIGINT, *_ENDINGS), note):
        yield
    if came:
        signal.raise_signal(came[0])


class UninterruptedEnd(AbstractContextManager[_EnteredT, bool | None]):
    """A context whose end is never interrupted, for example that of a robot that must stop."""

    def __init__(
        self, context: AbstractContextManager[_EnteredT, bool | None], notice: str | None = None
    ) -> None:
        """Wrap a context that has not been entered yet.

        Args:
            context: The context.
            notice: Text for standard error when an interruption has to wait for its end.
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
        """Leave it; an interruption during that is raised afterwards."""
        with interruptions_put_off(self._notice):
            return self._context.__exit__(kind, error, traceback)


def interrupt() -> None:
    """End the command as Ctrl-C does, from any thread."""
    _send(signal.SIGINT)


def _send(number: signal.Signals) -> None:
    signal.pthread_kill(threading.main_thread().ident or 0, number)


@contextmanager
def _handled(
    numbers: tuple[signal.Signals, ...], handler: Callable[[int, FrameType | None], None]
) -> Iterator[None]:
    """Handle signals in the block, except those of a terminal if they are ignored.

    ``nohup`` ignores SIGHUP; a shell's background job ignores SIGINT.
    """
    before = {
        number: signal.signal(number, handler)
        for number in numbers
        if number is signal.SIGTERM or signal.getsignal(number) is not signal.SIG_IGN
    }
    try:
        yield
    finally:
        for number, earlier in before.items():
            signal.signal(number, earlier)


@contextmanager
def _raised_again() -> Iterator[None]:
    """Send an interruption once more that came where Python only reports what is raised.

    It does so in callbacks of weak references, such as those of imports, and the block would go on.
    """
    report = sys.unraisablehook

    def send_or_report(raised: "sys.UnraisableHookArgs") -> None:
        if not isinstance(raised.exc_value, KeyboardInterrupt):
            report(raised)
            return
        _last_s[0] = -math.inf  # nobody has heard it
        number = signal.SIGTERM if isinstance(raised.exc_value, Terminated) else signal.SIGINT
        again = threading.Timer(_AGAIN_S, _send, (number,))
        again.daemon = True
        again.start()

    sys.unraisablehook = send_or_report
    try:
        yield
    finally:
        sys.unraisablehook = report


def _raise_or_end(number: int, _frame: FrameType | None) -> None:
    before_s, now_s = _last_s[0], time.monotonic()
    if now_s - before_s < _SAME_S:
        return
    _last_s[0] = now_s
    if now_s - before_s < _INSISTING_S:
        with suppress(OSError):
            os.write(2, b"\nhypernav: interrupted twice, so ended at once\n")
        os._exit(128 + number if number == signal.SIGINT else 128 + signal.SIGTERM)
    raise KeyboardInterrupt if number == signal.SIGINT else Terminated
