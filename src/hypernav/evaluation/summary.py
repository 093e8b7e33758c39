"""Mean results of a run, or of a part of it."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from hypernav.evaluation.failures.classification import Failure
from hypernav.evaluation.protocol import EvaluationProtocol
from hypernav.evaluation.record import EpisodeRecord
from hypernav.evaluation.statistics import DRAWS, Estimate, mean_with_interval


@dataclass(frozen=True)
class Summary:
    """Mean results of some episodes under one protocol; episodes that don't count are left out.

    Attributes:
        success: Success rate.
        spl: Mean SPL.
        soft_spl: Mean SoftSPL.
        distance_to_goal_m: Mean distance at the end, over episodes whose goal can be reached.
        steps: Mean number of actions.
    """

    success: Estimate
    spl: Estimate
    soft_spl: Estimate
    distance_to_goal_m: Estimate
    steps: Estimate


def counted(records: Sequence[EpisodeRecord]) -> list[EpisodeRecord]:
    """The records that count in rates."""
    return [record for record in records if record.counts]


def summarise(
    records: Sequence[EpisodeRecord],
    protocol: EvaluationProtocol | None = None,
    *,
    draws: int = DRAWS,
) -> Summary:
    """Mean results of some episodes.

    Args:
        records: Records of one run.
        protocol: Protocol that decides about success; Habitat's by default.
        draws: Number of bootstrap samples of the intervals.
    """
    protocol = protocol or EvaluationProtocol()
    records = sorted(counted(records), key=lambda record: record.key)  # as draws depend on it
    scores = [protocol.score(record) for record in records]
    scenes = [record.scene_id for record in records]

    def estimate(values: list[float]) -> Estimate:
        return mean_with_interval(values, scenes, draws=draws)

    near = [r for r in records if r.distance_to_goal_m < float("inf")]
    return Summary(
        success=estimate([float(score.success) for score in scores]),
        spl=estimate([score.spl for score in scores]),
        soft_spl=estimate([score.soft_spl for score in scores]),
        distance_to_goal_m=mean_with_interval(
            [r.distance_to_goal_m for r in near], [r.scene_id for r in near], draws=draws
        ),
        steps=estimate([float(record.steps) for record in records]),
    )


def failure_counts(records: Sequence[EpisodeRecord]) -> dict[Failure, int]:
    """Number of episodes of each failure class that occurs, in the order of `Failure`."""
    counts = Counter(record.failure for record in records if record.failure is not None)
    return {failure: counts[failure] for failure in Failure if counts[failure]}
