"""The protocols under which an episode is scored.

Publications differ in two things. The success distance runs from 0.1 m (Habitat's challenges) to
1.0 m. And some count a robot that runs out of steps beside the goal without STOP. A record keeps
the lengths that all of them need, so no episode has to be run again.
"""

from dataclasses import dataclass
from enum import StrEnum

from hypernav.core.metrics import SUCCESS_DISTANCE_M, EpisodeMetrics, measure
from hypernav.evaluation.record import EpisodeRecord

SUCCESS_DISTANCES_M = (0.1, 0.2, 0.25, 0.3, 1.0)
"""All success distances that results are scored under."""


class StopRule(StrEnum):
    """Whether a success needs a STOP."""

    STOP_REQUIRED = "stop required"
    """A success needs a STOP near the goal (Habitat, Anderson et al. 2018)."""
    TIMEOUT_COUNTS = "time-out near the goal counts"
    """An episode that ends near the goal is a success, however it ended."""


@dataclass(frozen=True)
class EvaluationProtocol:
    """A success distance with a stop rule.

    Attributes:
        success_distance_m: Geodesic distance to the nearest view point that counts as reached.
        stop_rule: Whether a success needs a STOP.
    """

    success_distance_m: float = SUCCESS_DISTANCE_M
    stop_rule: StopRule = StopRule.STOP_REQUIRED

    def score(self, record: EpisodeRecord) -> EpisodeMetrics:
        """The measures of an episode under this protocol."""
        return measure(
            stopped=record.stopped or self.stop_rule is StopRule.TIMEOUT_COUNTS,
            distance_to_goal_m=record.distance_to_goal_m,
            shortest_path_m=record.shortest_path_m,
            path_length_m=record.path_length_m,
            success_distance_m=self.success_distance_m,
        )


PROTOCOLS = tuple(
    EvaluationProtocol(distance, rule) for rule in StopRule for distance in SUCCESS_DISTANCES_M
)
"""Every success distance with every stop rule."""
