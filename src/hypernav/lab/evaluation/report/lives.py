"""What a report says about lives: by number of the goal, life by life, and by GOAT-Bench's rules.

GOAT-Bench has two rules, which contradict each other. Its README counts a STOP within 1 m of the
object, after at most 500 steps a goal; its code one within 0.25 m of a view point. One run is
scored by both: by the README's, a search of more than 500 steps failed, but the robot went on, so
the next goal began elsewhere than with that limit.
"""

from collections.abc import Callable, Sequence, Set
from dataclasses import dataclass
from itertools import groupby

from hypernav.lab.evaluation.protocol import EvaluationProtocol, Reference
from hypernav.lab.evaluation.record import EpisodeRecord
from hypernav.lab.evaluation.report.run_data import RunData
from hypernav.lab.evaluation.report.tables import own_protocol
from hypernav.lab.evaluation.statistics import (
    Comparison,
    Estimate,
    compare,
    mean_with_interval,
    ratio_with_interval,
)

GOAT_RULES = {
    "the code: within 0.25 m of a view point": EvaluationProtocol(0.25),
    "the README: within 1 m of the object, 500 steps": EvaluationProtocol(
        1.0, reference=Reference.OBJECT, most_steps=500
    ),
}
"""The rules by their names for people."""

ALL = "all goals"


@dataclass(frozen=True)
class RuleScore:
    """Results under one rule.

    Attributes:
        success: Success rate over goals.
        spl: Mean SPL over goals, each from where the robot stood.
        partial_success: Mean over lives of the share of goals that were found, of the lives whose
            goals all count; None if there are none.
        whole_success: Share of these lives in which all goals were found.
    """

    success: Estimate
    spl: Estimate
    partial_success: Estimate | None
    whole_success: Estimate | None


@dataclass(frozen=True)
class GoalTypeRow:
    """Results of the goals of one type.

    Attributes:
        name: Goal type, or `ALL`.
        count: Number of goals.
        scores: Results by the rules of `GOAT_RULES`, in their order; None where the records lack
            what a rule needs: the README's needs annotations of the scenes.
    """

    name: str
    count: int
    scores: list[RuleScore | None]


def has_goal_types(run: RunData) -> bool:
    """Whether a run's data set is GOAT-Bench, the only one with several types of goals."""
    return "goal_types" in run.configuration


def by_goal_type(run: RunData) -> list[GoalTypeRow]:
    """The results of a run of GOAT-Bench by goal type, all goals first."""
    types = sorted({record.group for record in run.counted})
    cut_short = {(one.scene_id, one.life) for one in run.records if not one.counts}
    named = [(ALL, run.counted)]
    named += [(kind, [r for r in run.counted if r.group == kind]) for kind in types]
    return [
        GoalTypeRow(
            name, len(goals), [_score(goals, rule, cut_short) for rule in GOAT_RULES.values()]
        )
        for name, goals in named
    ]


def _score(
    goals: Sequence[EpisodeRecord], rule: EvaluationProtocol, cut_short: Set[tuple[str, str]]
) -> RuleScore | None:
    if not rule.can_score(goals):
        return None
    scenes = [goal.scene_id for goal in goals]
    scores = [rule.score(goal) for goal in goals]
    found = [float(score.success) for score in scores]
    lives = [
        (key[0], [success for _, success in group])
        for key, group in groupby(
            sorted(zip([(g.scene_id, g.life) for g in goals], found, strict=True)),
            key=lambda pair: pair[0],
        )
        if key not in cut_short
    ]
    of_lives = [scene for scene, _ in lives]
    return RuleScore(
        success=mean_with_interval(found, scenes),
        spl=mean_with_interval([score.spl for score in scores], scenes),
        partial_success=_mean([sum(f) / len(f) for _, f in lives], of_lives),
        whole_success=_mean([float(all(f)) for _, f in lives], of_lives),
    )


def _mean(values: Sequence[float], scenes: Sequence[str]) -> Estimate | None:
    return mean_with_interval(values, scenes) if values else None


LATER = "all after the first"
"""Name of the row of all goals for which there is something to remember."""


@dataclass(frozen=True)
class GoalNumberRow:
    """Results of the goals that come at one place in their lives.

    Attributes:
        name: Number of the goal, from 1, or `LATER`.
        success: Success rate in every run; None where it has no such goal.
        spl: Mean SPL in every run, each from where the robot stood.
        steps: Mean number of steps in every run.
    """

    name: str
    success: list[Estimate | None]
    spl: list[Estimate | None]
    steps: list[Estimate | None]


@dataclass(frozen=True)
class GoalNumberPair:
    """One run against another on the goals of one place in their lives that count in both.

    Attributes:
        name: Number of the goal, from 1, or `LATER`.
        count: Number of these goals.
        spl_ratio: SPL of the second run over that of the first; None if the first has none.
        spl: Difference of SPL, the second minus the first.
        success: Difference of the success rates.
    """

    name: str
    count: int
    spl_ratio: Estimate | None
    spl: Comparison
    success: Comparison


@dataclass(frozen=True)
class LifeRecord:
    """The result of one life.

    Attributes:
        scene_id: Name of the building.
        life: Name of the life, unique within the building.
        goals: Number of goals.
        found: Number of goals that were found.
        share_found: The one over the other; GOAT-Bench calls it partial success.
        spl: Mean SPL of the goals.
        steps: Number of steps.
        path_length_m: Length of the path driven.
    """

    scene_id: str
    life: str
    goals: int
    found: int
    share_found: float
    spl: float
    steps: int
    path_length_m: float


def has_lives(runs: Sequence[RunData]) -> bool:
    """Whether some run has goals that belong to lives."""
    return any(record.life for run in runs for record in run.records)


def by_goal_number(runs: Sequence[RunData]) -> list[GoalNumberRow]:
    """A row for every place in a life, and one for all but the first."""
    return [
        GoalNumberRow(
            name,
            [_estimate(run, numbers, lambda r, p: float(p.score(r).success)) for run in runs],
            [_estimate(run, numbers, lambda r, p: p.score(r).spl) for run in runs],
            [_estimate(run, numbers, lambda r, _: float(r.steps)) for run in runs],
        )
        for name, numbers in _places(runs)
    ]


def paired_by_goal_number(first: RunData, second: RunData) -> list[GoalNumberPair]:
    """The second run against the first, for every place in a life."""
    a, b, protocol = first.by_key, second.by_key, own_protocol(first)
    found = []
    for name, numbers in _places([first, second]):
        both = [
            key
            for key, record in a.items()
            if key in b and record.life and record.goal_number in numbers
        ]
        if not both:
            continue
        scenes = [scene for scene, _ in both]
        scores = [(protocol.score(a[key]), protocol.score(b[key])) for key in both]
        spl = [x.spl for x, _ in scores], [y.spl for _, y in scores]
        success = [float(x.success) for x, _ in scores], [float(y.success) for _, y in scores]
        ratio = ratio_with_interval(spl[1], spl[0], scenes) if any(spl[0]) else None
        pair = (ratio, compare(*spl, scenes), compare(*success, scenes))
        found.append(GoalNumberPair(name, len(both), *pair))
    return found


def life_records(run: RunData) -> list[LifeRecord]:
    """A record of every life whose goals all count, by scene and name."""
    protocol = own_protocol(run)

    def life_of(record: EpisodeRecord) -> tuple[str, str]:
        return (record.scene_id, record.life)

    lived = sorted((record for record in run.records if record.life), key=life_of)
    lives = [list(goals) for _, goals in groupby(lived, key=life_of)]
    return [_life_record(goals, protocol) for goals in lives if all(one.counts for one in goals)]


def _life_record(goals: Sequence[EpisodeRecord], protocol: EvaluationProtocol) -> LifeRecord:
    scores = [protocol.score(record) for record in goals]
    found = sum(score.success for score in scores)
    return LifeRecord(
        scene_id=goals[0].scene_id,
        life=goals[0].life,
        goals=len(goals),
        found=found,
        share_found=found / len(goals),
        spl=sum(score.spl for score in scores) / len(goals),
        steps=sum(record.steps for record in goals),
        path_length_m=sum(record.path_length_m for record in goals),
    )


def _places(runs: Sequence[RunData]) -> list[tuple[str, range]]:
    numbers = [record.goal_number for run in runs for record in run.records if record.life]
    most = max(numbers, default=0)
    each = [(str(number), range(number, number + 1)) for number in range(1, most + 1)]
    return [*each, (LATER, range(2, most + 1))] if most > 1 else each


def _estimate(
    run: RunData, numbers: range, value: Callable[[EpisodeRecord, EvaluationProtocol], float]
) -> Estimate | None:
    protocol = own_protocol(run)
    goals = [one for one in run.counted if one.life and one.goal_number in numbers]
    values = [value(one, protocol) for one in goals]
    return mean_with_interval(values, [one.scene_id for one in goals]) if goals else None
