"""A run of GOAT-Bench under its two rules, which contradict each other.

Its README counts a STOP within 1 m of the object, after at most 500 steps a goal; its code one
within 0.25 m of a view point. One run is scored by both: by the README's, a search of more than 500
steps failed, but the robot went on, so the next goal began elsewhere than with that limit.
"""

from collections.abc import Sequence, Set
from dataclasses import dataclass
from itertools import groupby

from hypernav.evaluation.protocol import EvaluationProtocol, Reference
from hypernav.evaluation.record import EpisodeRecord
from hypernav.evaluation.report.run_data import RunData
from hypernav.evaluation.statistics import Estimate, mean_with_interval

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
