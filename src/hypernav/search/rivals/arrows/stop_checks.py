"""The question whether the robot is at the goal, for methods without a detector of it."""

from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Bool

from hypernav.core.geometry.depth import is_measured
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import ExchangeLog
from hypernav.search.perception.exchanges import YesNoAsker, yes_no_question
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from hypernav.search.rivals.config import StopCheckConfig

_MORE_YES_THAN_NO = 0.5
_NEAR_M = 1.0
"""Distance up to which `TruthStopCheck` says yes, metres; ours."""


@runtime_checkable
class StopCheck(Protocol):
    """Tells whether the robot is at the goal."""

    def is_here(self, observation: Observation, goal: Goal) -> bool:
        """Whether the image shows the goal right before the robot."""
        ...


@dataclass(eq=False)
class ChatStopCheck(YesNoAsker):
    """Asks a vision-language model.

    Attributes:
        config: Configuration of the question.
    """

    config: StopCheckConfig = field(default_factory=StopCheckConfig)

    count_name = "unsure_stop_checks"

    def is_here(self, observation: Observation, goal: Goal) -> bool:
        """Whether the model says yes; an answer that is neither yes nor no counts as no.

        Raises:
            ModelUnavailableError: The model did not answer within the configured patience.
        """
        text = goal.named_in(self.config.prompt)
        yes = self.ask(yes_no_question("stop", text, observation.rgb), "taken for no")
        return yes is not None and yes >= _MORE_YES_THAN_NO


@dataclass(frozen=True, eq=False)
class TruthStopCheck:
    """Says by true labels and depth whether the goal is near: a stand-in for a model.

    Ours; nothing like it was published.

    Attributes:
        log: Log of all answers, for the trace.
    """

    log: ExchangeLog

    warning = "stops by the truth in view, in place of a vision-language model (--vlm)"

    def is_here(self, observation: Observation, goal: Goal) -> bool:
        """Whether labelled pixels of the goal are within 1 m along the floor.

        Raises:
            LabelsMissingError: The world supplies no labels.
        """
        found = GroundTruthDetector().detect(observation, goal)
        distances = [
            _floor_distance(observation, one.mask) for one in found if one.mask is not None
        ]
        away_m = min(distances, default=np.inf)
        here = bool(away_m <= _NEAR_M)
        seen = f"{away_m:.1f} m away" if np.isfinite(away_m) else "not in view"
        question = f"Is the {goal.thing} within {_NEAR_M:g} m?"
        self.log.note("stop", "truth", question, f"{'yes' if here else 'no'}: {seen}")
        return here


def _floor_distance(observation: Observation, mask: Bool[np.ndarray, "height width"]) -> float:
    """Distance from the robot to the nearest masked pixel with depth, along the floor, metres."""
    rows, columns = np.nonzero(mask & is_measured(observation.depth))
    if not len(rows):
        return np.inf
    at = observation.points_at(rows, columns)[:, :2]
    return float(np.hypot(*(at - np.array(observation.robot.xy)).T).min())
