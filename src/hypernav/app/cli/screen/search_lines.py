"""What the terminal says of a search: warnings, what the robot does, and how it ended."""

import difflib
import logging
import math
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console
from rich.logging import RichHandler
from rich.markup import escape

from hypernav.app.show.captions import floor_prefix
from hypernav.core.episode import Outcome
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel, normalise

if TYPE_CHECKING:
    from hypernav.lab.episodes.episode_run import EpisodeResult, EpisodeStep
    from hypernav.search.memory.start.relocalization import FoundStart

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


_ENDINGS = {
    Outcome.FOUND: "[green]found[/] {goal}",
    Outcome.WRONG_PLACE: "[red]stopped[/], but not at {goal}",
    Outcome.NOT_FOUND: "[yellow]did not find[/] {goal}",
    Outcome.UNREACHABLE: "[yellow]no path leads[/] to {goal} from this start",
    Outcome.MODEL_UNAVAILABLE: "[red]the model was unavailable[/]; the search is not counted",
    Outcome.INTERRUPTED: "[yellow]interrupted[/] while looking for {goal}",
}
"""How a search for a goal, `Goal.in_sentence`, ended."""


def ending_words(outcome: Outcome, goal: Goal) -> str:
    """How a search ended, with the terminal's markup."""
    return _ENDINGS[outcome].format(goal=escape(goal.in_sentence))


def found_start_line(found: "FoundStart", memory: Path | None) -> str:
    """Where the robot is in the memory, in a line for the terminal."""
    if found.doubt or found.place is None:
        return (
            f"[yellow]where the robot is in {escape(str(memory))} isn't clear: {found.doubt}; the "
            "search begins anew, and that memory stays as it is[/]"
        )
    x, y = found.place.own.xy
    return (
        f"the robot is at ({x:z.1f}, {y:z.1f}) on floor {found.place.floor + 1} of "
        f"{escape(str(memory))}, by one turn"
    )


def live_line(step: "EpisodeStep") -> str:
    """What the robot is doing, in a line for the status of the terminal."""
    trace = step.trace
    seen = "goal in sight" if trace.goal_area else "goal not seen yet"
    return f"{floor_prefix(trace)}step {trace.step + 1} · {trace.mode} · {seen} · {trace.reason}"


def print_result(console: Console, goal: Goal, result: "EpisodeResult") -> None:
    """Print how a search ended, and what it took."""
    metrics = result.metrics
    console.print(ending_words(result.outcome, goal))
    if result.detail:
        console.print(f"  {escape(result.detail)}", soft_wrap=True)
    lengths = [f"{metrics.path_length_m:.1f} m driven"]
    if math.isfinite(metrics.shortest_path_m):
        lengths.append(f"shortest {metrics.shortest_path_m:.1f} m")
    if math.isfinite(metrics.distance_to_goal_m):
        lengths.append(f"{metrics.distance_to_goal_m:.2f} m from the goal")
    console.print(
        f"  {result.steps} steps, {', '.join(lengths)}, SPL {metrics.spl:.2f}, "
        f"{result.seconds['total']:.0f} s",
        soft_wrap=True,
    )
