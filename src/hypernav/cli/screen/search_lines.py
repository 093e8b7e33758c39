"""What the terminal says of a search: where it began, what it does, and how it ended."""

import math
from pathlib import Path

from rich.console import Console
from rich.markup import escape

from hypernav.core.episode import Outcome
from hypernav.core.goal import Goal
from hypernav.episodes.episode_run import EpisodeResult, EpisodeStep
from hypernav.mapping.memory.relocalization import FoundStart
from hypernav.show.captions import floor_prefix

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


def found_start_line(found: FoundStart, memory: Path | None) -> str:
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


def live_line(step: EpisodeStep) -> str:
    """What the robot is doing, in a line for the status of the terminal."""
    trace = step.trace
    seen = "goal in sight" if trace.goal_area else "goal not seen yet"
    return f"{floor_prefix(trace)}step {trace.step + 1} · {trace.mode} · {seen} · {trace.reason}"


def print_result(console: Console, goal: Goal, result: EpisodeResult) -> None:
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
