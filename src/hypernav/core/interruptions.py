"""Interruptions that come while compiled code runs."""

from collections.abc import Iterator
from contextlib import contextmanager


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
