"""The package's warnings on the terminal."""

import difflib
import logging
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager

from rich.console import Console
from rich.logging import RichHandler
from rich.markup import escape

from hypernav.core.goal import Goal
from hypernav.core.labels import ObjectLabel, normalise

_MOST_KINDS = 8
"""Largest number of kinds of objects that a line names."""


@contextmanager
def warnings_on(console: Console, *, level: int = logging.WARNING) -> Iterator[None]:
    """Print warnings (such as the retry of a request) on the console while the block runs.

    Args:
        console: The console.
        level: Lowest level that is printed.
    """
    logger = logging.getLogger("hypernav")
    handler = RichHandler(level, console, show_time=False, show_level=False, show_path=False)
    logger.addHandler(handler)
    try:
        yield
    finally:
        logger.removeHandler(handler)


def unusable_answers_line(calls: int, unusable: Mapping[str, int]) -> str:
    """A warning if no answer of a model could be used, in rich's markup; empty otherwise.

    Args:
        calls: Number of questions that the model answered.
        unusable: Number of unusable answers, by reason.
    """
    if not calls or sum(unusable.values()) < calls:
        return ""
    ranked = sorted(unusable.items(), key=lambda item: -item[1])
    reasons = ", ".join(f"{count} × {reason}" for reason, count in ranked)
    return (
        f"  [yellow]no answer of the model could be used[/]: {escape(reasons)}; "
        "hypernav doctor --vlm … finds out why"
    )


def no_such_object_line(goal: Goal, labels: Iterable[ObjectLabel]) -> str:
    """A warning that a building holds no object that a goal asks for, in rich's markup.

    Args:
        goal: The goal.
        labels: What its objects are.
    """
    labels = list(labels)
    names = sorted({normalise(name) for label in labels for name in label.names})
    kinds = sorted({label.category for label in labels})
    if close := difflib.get_close_matches(normalise(goal.text), names, n=1, cutoff=0.75):
        hint = f"did you mean '{close[0]}'?"
    elif kinds:
        more = f" and {len(kinds) - _MOST_KINDS} other kinds" * (len(kinds) > _MOST_KINDS)
        hint = f"it holds {', '.join(kinds[:_MOST_KINDS])}{more}."
    else:
        hint = "no object in it has a name; an objects.json beside its file gives them names."
    return (
        f"[yellow]nothing in this building answers to '{escape(goal.text)}'[/]; {escape(hint)} "
        "The search runs anyway."
    )
