"""The protocols under which an episode is scored.

Publications differ in three ways. The success distance is between 0.1 m (Habitat's challenges) and
1.0 m. It is measured from a view point or, in some, from the object itself. And some count it as a
success if the robot runs out of steps near the goal, without STOP. A record keeps the lengths that
all of them need, so no episode has to be run again.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

from hypernav.core.episode import SUCCESS_DISTANCE_M, EpisodeMetrics, measure
from hypernav.lab.evaluation.record import EpisodeRecord

SUCCESS_DISTANCES_M = (0.1, 0.2, 0.25, 0.3, 1.0)
"""All success distances from view points that results are scored with."""
OBJECT_DISTANCE_M = 1.0
"""The success distance from the object that results are also scored with."""


class StopRule(StrEnum):
    """Whether a success needs a STOP."""

    STOP_REQUIRED = "stop required"
    """A success needs a STOP near the goal (Habitat, Anderson et al. 2018)."""
    TIMEOUT_COUNTS = "time-out near the goal counts"
    """An episode that ends near the goal is a success, however it ended."""


class Reference(StrEnum):
    """What the success distance is measured from."""

    VIEW_POINT = "view point"
    """The nearest view point, geodesic (Habitat)."""
    OBJECT = "object"
    """The surface of the nearest goal object, straight in the plane, through walls too."""


@dataclass(frozen=True)
class EvaluationProtocol:
    """A success distance with a stop rule.

    Attributes:
        success_distance_m: Distance that counts as reached, metres.
        stop_rule: Whether a success needs a STOP.
        reference: What that distance is measured from.
        most_steps: Greatest number of steps of a success; None for that of the run.
    """

    success_distance_m: float = SUCCESS_DISTANCE_M
    stop_rule: StopRule = StopRule.STOP_REQUIRED
    reference: Reference = Reference.VIEW_POINT
    most_steps: int | None = None

    @property
    def reached(self) -> str:
        """What counts as reached, in words."""
        near = f"within {self.success_distance_m:g} m"
        return near if self.reference is Reference.VIEW_POINT else f"{near} of the object"

    def score(self, record: EpisodeRecord) -> EpisodeMetrics:
        """The measures of an episode under this protocol.

        The shortest path of SPL leads to the nearest view point under every protocol.
        """
        distance_m = record.distance_to_goal_m
        if self.reference is Reference.OBJECT:
            to_object_m = record.distance_to_object_m
            distance_m = math.inf if to_object_m is None else to_object_m
        in_time = self.most_steps is None or record.steps <= self.most_steps
        return measure(
            stopped=in_time and (record.stopped or self.stop_rule is StopRule.TIMEOUT_COUNTS),
            distance_to_goal_m=distance_m,
            shortest_path_m=record.shortest_path_m,
            path_length_m=record.path_length_m,
            success_distance_m=self.success_distance_m,
        )

    def can_score(self, records: Sequence[EpisodeRecord]) -> bool:
        """Whether records have the distance that this protocol needs; old ones may lack it."""
        return self.reference is Reference.VIEW_POINT or any(
            record.distance_to_object_m is not None for record in records
        )


_REACHES = (
    *(EvaluationProtocol(distance) for distance in SUCCESS_DISTANCES_M),
    EvaluationProtocol(OBJECT_DISTANCE_M, reference=Reference.OBJECT),
)

PROTOCOLS = tuple(replace(reach, stop_rule=rule) for rule in StopRule for reach in _REACHES)
"""Every success distance with every stop rule."""
