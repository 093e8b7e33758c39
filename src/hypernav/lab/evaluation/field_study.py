"""The table of a field study: success and SPL by goal and method, like the paper's last table."""

from collections.abc import Sequence
from dataclasses import dataclass

from hypernav.lab.evaluation.statistics import Estimate, mean_with_interval

ALL_GOALS = "all goals"


@dataclass(frozen=True)
class TrialResult:
    """Result of one trial.

    Attributes:
        goal: What was searched for.
        method: Method that searched.
        success: Whether it was found.
        spl: Success weighted by path length, lengths by odometry.
        length_m: Length of the path driven, metres.
        shortest_m: Length of the shortest path, measured by hand, metres.
    """

    goal: str
    method: str
    success: bool
    spl: float
    length_m: float
    shortest_m: float


@dataclass(frozen=True)
class StudyRow:
    """One row of the table.

    Attributes:
        goal: What was searched for, or `ALL_GOALS`.
        method: Method that searched.
        count: Number of trials.
        found: Number of trials that succeeded.
        success: Success rate.
        spl: Mean SPL.
        length_m: Mean length of the path driven, metres.
        shortest_m: Mean length of the shortest path, metres.
    """

    goal: str
    method: str
    count: int
    found: int
    success: Estimate
    spl: Estimate
    length_m: float
    shortest_m: float


def study_rows(results: Sequence[TrialResult]) -> list[StudyRow]:
    """The table: methods within goals, in the order of their first trial, then all goals together.

    Intervals are over trials, because there is only one building.
    """
    goals, methods = (
        list(dict.fromkeys(names))
        for names in ([r.goal for r in results], [r.method for r in results])
    )
    rows = []
    for goal in [*goals, ALL_GOALS]:
        for method in methods:
            chosen = [r for r in results if r.method == method and goal in (r.goal, ALL_GOALS)]
            if chosen:
                rows.append(_row(goal, method, chosen))
    return rows


def _row(goal: str, method: str, results: Sequence[TrialResult]) -> StudyRow:
    building = ["one building"] * len(results)
    return StudyRow(
        goal=goal,
        method=method,
        count=len(results),
        found=sum(result.success for result in results),
        success=mean_with_interval([float(result.success) for result in results], building),
        spl=mean_with_interval([result.spl for result in results], building),
        length_m=sum(result.length_m for result in results) / len(results),
        shortest_m=sum(result.shortest_m for result in results) / len(results),
    )
