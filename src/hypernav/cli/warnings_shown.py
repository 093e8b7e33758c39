"""The package's warnings on the terminal."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.logging import RichHandler


@contextmanager
def warnings_on(console: Console) -> Iterator[None]:
    """Print warnings (such as the retry of a request) on the console while the block runs."""
    logger = logging.getLogger("hypernav")
    handler = RichHandler(
        logging.WARNING, console, show_time=False, show_level=False, show_path=False
    )
    logger.addHandler(handler)
    try:
        yield
    finally:
        logger.removeHandler(handler)
