"""Interruptions that come while compiled code runs."""

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def interruptions_of_kernels() -> Iterator[None]:
    """Raise an interruption in the block as what it is, also where a compiled function ran.

    If the handler of a signal raises while a function of numba's returns, Python finds a result and
    an error at once, and raises `SystemError` with the interruption as its cause.

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
