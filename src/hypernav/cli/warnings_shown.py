"""The package's warnings on the terminal."""

import logging
from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from rich.console import Console
from rich.logging import RichHandler
from rich.markup import escape


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


def unusable_answers_line(calls: int, unusable: Mapping[str, int]) -> str:
    """A warning if no answer of a model could be used, in rich's markup; empty otherwise.

    Args:
        calls: Number of questions that the model answered.
        unusable: Number of answers of no use, by reason.
    """
    if not calls or sum(unusable.values()) < calls:
        return ""
    ranked = sorted(unusable.items(), key=lambda item: -item[1])
    reasons = ", ".join(f"{count} × {reason}" for reason, count in ranked)
    return (
        f"  [yellow]no answer of the model could be used[/]: {escape(reasons)}; "
        "hypernav doctor --vlm … finds out why"
    )
