"""Looking once more, at the goal, before the robot declares success (paper: Stop)."""

from typing import Any, Literal

from pydantic import Field

from hypernav.core.chat import Image, Question
from hypernav.core.config import RoomConfig
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.protocols import ChatModel
from hypernav.core.trace import ExchangeLog
from hypernav.perception.exchanges import exchange_of

_PROMPT = "Is there a {goal} in this picture? Answer yes or no."


class PresenceConfig(RoomConfig):
    """How the last question is asked.

    Attributes:
        enabled: Ask it at all, where a chat model is at hand.
        prompt: The question; ``{goal}`` is filled in.
        unsure: What an answer that is neither counts as. "yes" trusts the detector.
        min_probability: Of "yes", where the model tells probabilities.
    """

    enabled: bool = True
    prompt: str = _PROMPT
    unsure: Literal["yes", "no"] = "yes"
    min_probability: float = Field(default=0.5, ge=0.0, le=1.0)


def presence_question(config: PresenceConfig, image: Image, goal: Goal) -> Question:
    """What a model is asked at the goal."""
    return Question(
        kind="verify",
        text=config.prompt.replace("{goal}", goal.text.strip()),
        images=(image,),
        allowed=("yes", "no"),
        max_tokens=8,
    )


class VlmPresenceCheck:
    """Asks a vision-language model whether the goal is really in the image."""

    def __init__(
        self, chat: ChatModel, log: ExchangeLog, config: PresenceConfig | None = None
    ) -> None:
        """Create the check.

        Args:
            chat: Who is asked.
            log: Where every question and answer is written for the trace.
            config: How it is asked.
        """
        self._chat = chat
        self._log = log
        self._config = config or PresenceConfig()
        self.unsure = 0
        """Answers so far that were neither yes nor no."""

    def take_report(self) -> dict[str, Any]:
        """The answers that were neither yes nor no since the last call."""
        report, self.unsure = {"unsure_presence_checks": self.unsure}, 0
        return report

    def is_present(self, observation: Observation, goal: Goal) -> bool:
        """Ask yes or no.

        Raises:
            ModelUnavailableError: The model stayed away for longer than the configured patience.
        """
        question = presence_question(self._config, observation.rgb, goal)
        answer = self._chat.ask(question)
        remarks = []
        if answer.fault is not None:
            self.unsure += 1
            remarks = [f"{answer.detail}; taken for {self._config.unsure}"]
            present = self._config.unsure == "yes"
        elif "yes" in answer.probabilities:
            present = answer.probabilities["yes"] >= self._config.min_probability
        else:
            present = answer.value == "yes"
        self._log.record(exchange_of(question, answer, remarks=remarks))
        return present
