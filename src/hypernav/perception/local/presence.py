"""The presence check at the goal, before the robot declares success (paper: Termination)."""

from dataclasses import dataclass, field
from typing import Literal

from pydantic import Field

from hypernav.core.chat import Image, Question
from hypernav.core.config import RoomConfig
from hypernav.core.curve import Curve, along
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.perception.exchanges import YesNoAsker, yes_no_question

_PROMPT = "Is there a {goal} in this picture? Answer yes or no."


class PresenceConfig(RoomConfig):
    """Configuration of the presence check. The paper does not give its question: this one is ours.

    Attributes:
        enabled: Whether to ask, where there is a chat model.
        prompt: Text of the question; ``{goal}`` is filled in without its own article, and
            ``a {goal}`` with the right one.
        unsure: What an answer that is neither yes nor no counts as. "yes" trusts the detector.
        min_probability: Least probability of a "yes", where the model gives probabilities.
        calibration: Told and true probabilities of "yes", in rising order, as measured by an exam;
            empty takes the model at its word.
    """

    enabled: bool = True
    prompt: str = _PROMPT
    unsure: Literal["yes", "no"] = "no"
    min_probability: float = Field(default=0.5, gt=0.0, le=1.0)
    calibration: Curve = ()


def presence_question(config: PresenceConfig, image: Image, goal: Goal) -> Question:
    """Question to a model whether an image (RGB) shows the goal."""
    return yes_no_question("verify", goal.named_in(config.prompt), image)


@dataclass(eq=False)
class VlmPresenceCheck(YesNoAsker):
    """Asks a vision-language model whether the goal is really in the image.

    Attributes:
        config: Configuration of the question.
    """

    config: PresenceConfig = field(default_factory=PresenceConfig)

    count_name = "unsure_presence_checks"

    def is_present(self, observation: Observation, goal: Goal) -> bool:
        """Whether the model says yes.

        Raises:
            ModelUnavailableError: The model did not answer within the configured patience.
        """
        question = presence_question(self.config, observation.rgb, goal)
        yes = self.ask(question, f"taken for {self.config.unsure}")
        if yes is None:
            return self.config.unsure == "yes"
        if self.config.calibration:
            yes = along(self.config.calibration, yes)
        return yes >= self.config.min_probability
