"""The question whether the robot is at the goal, for methods that ask it instead of detecting."""

from typing import Any, Protocol, runtime_checkable

import numpy as np
from jaxtyping import Bool

from hypernav.core.components.protocols import ChatModel
from hypernav.core.config import RoomConfig
from hypernav.core.geometry.depth import is_measured
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import Exchange, ExchangeLog
from hypernav.perception.local.ground_truth import GroundTruthDetector
from hypernav.perception.yes_or_no import YesNoAsker, yes_no_question

_PROMPT = (
    "A robot looks for a {goal}. The picture is what its camera sees now. Is the robot already "
    "VERY close to a real {goal}? Take care not to mistake another piece of furniture for it. If "
    "there is none, if it is far away or if you aren't sure, say no. Answer yes or no."
)
_MORE_YES_THAN_NO = 0.5
_NEAR_M = 1.0
"""Distance up to which the stand-in, which no model is, says yes; ours."""


class StopCheckConfig(RoomConfig):
    """The question whether to stop.

    Attributes:
        prompt: Text of the question, in substance VLMnav's; ``{goal}`` is filled in.
    """

    prompt: str = _PROMPT


@runtime_checkable
class StopCheck(Protocol):
    """Tells whether the robot is at the goal."""

    def is_here(self, observation: Observation, goal: Goal) -> bool:
        """Whether the image shows the goal right before the robot."""
        ...


class ChatStopCheck:
    """Asks a vision-language model."""

    def __init__(
        self, chat: ChatModel, log: ExchangeLog, config: StopCheckConfig | None = None
    ) -> None:
        """Create the check.

        Args:
            chat: Chat model to ask.
            log: Log of all questions and answers, for the trace.
            config: Configuration of the question.
        """
        self._asker = YesNoAsker(chat, log)
        self._config = config or StopCheckConfig()

    def take_report(self) -> dict[str, Any]:
        """Number of answers that were neither yes nor no since the last call."""
        return {"unsure_stop_checks": self._asker.take_unsure()}

    def is_here(self, observation: Observation, goal: Goal) -> bool:
        """Ask yes or no; anything else is a no.

        Raises:
            ModelUnavailableError: The model did not answer within the configured patience.
        """
        text = goal.named_in(self._config.prompt)
        yes = self._asker.ask(yes_no_question("stop", text, observation.rgb), "taken for no")
        return yes is not None and yes >= _MORE_YES_THAN_NO


class TruthStopCheck:
    """Says by true labels and depth whether the goal is near: a stand-in for a model.

    Ours; nothing like it was published.
    """

    warning = "stops by the truth in view, in place of a vision-language model (--vlm)"

    def __init__(self, log: ExchangeLog) -> None:
        """Create the check.

        Args:
            log: Log of all answers, for the trace.
        """
        self._log = log
        self._detector = GroundTruthDetector()

    def is_here(self, observation: Observation, goal: Goal) -> bool:
        """Whether labelled pixels of the goal are near.

        Raises:
            LabelsMissingError: The world supplies no labels.
        """
        found = self._detector.detect(observation, goal)
        distances = [
            _floor_distance(observation, one.mask) for one in found if one.mask is not None
        ]
        away_m = min(distances, default=np.inf)
        here = bool(away_m <= _NEAR_M)
        seen = f"{away_m:.1f} m away" if np.isfinite(away_m) else "not in view"
        self._log.record(
            Exchange(
                kind="stop",
                asked="truth",
                question=f"Is the {goal.thing} within {_NEAR_M:g} m?",
                answer=f"{'yes' if here else 'no'}: {seen}",
            )
        )
        return here


def _floor_distance(observation: Observation, mask: Bool[np.ndarray, "height width"]) -> float:
    """Distance from the robot to the nearest masked pixel with depth, along the floor, metres."""
    depth = observation.depth
    rows, columns = np.nonzero(mask & is_measured(depth))
    if not len(rows):
        return np.inf
    points = observation.camera.unproject_pixels(
        rows, columns, depth[rows, columns].astype(np.float64)
    )
    at = observation.camera_to_map.apply(points)[:, :2]
    return float(np.hypot(*(at - np.array(observation.robot.xy)).T).min())
