"""Scores by a chat model: how probable its yes is. Ours; VLFM compares image and text."""

from typing import Any

from hypernav.core.components.protocols import ChatModel
from hypernav.core.config import RoomConfig
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import ExchangeLog
from hypernav.perception.yes_or_no import YesNoAsker, yes_no_question

_PROMPT = (
    "You look for a {goal} in a building. Is the place in this picture one from which a {goal} is "
    "likely close by? Answer yes or no."
)
_UNSURE = 0.5
"""Score of an answer that is neither yes nor no."""


class ChatScorerConfig(RoomConfig):
    """The question. All of it is ours.

    Attributes:
        prompt: Text of the question; ``{goal}`` is filled in.
    """

    prompt: str = _PROMPT


class ChatScorer:
    """Asks whether the goal is likely near, and takes the probability of yes for the score.

    A model that tells no probabilities gives 1 or 0.
    """

    def __init__(
        self, chat: ChatModel, log: ExchangeLog, config: ChatScorerConfig | None = None
    ) -> None:
        """Create the scorer.

        Args:
            chat: Chat model to ask, once a step.
            log: Log of all questions and answers, for the trace.
            config: Configuration of the question.
        """
        self._asker = YesNoAsker(chat, log)
        self._config = config or ChatScorerConfig()

    def take_report(self) -> dict[str, Any]:
        """Number of answers that were neither yes nor no since the last call."""
        return {"unsure_scores": self._asker.take_unsure()}

    def score(self, observation: Observation, goal: Goal) -> float:
        """Probability of yes, 0 to 1.

        Raises:
            ModelUnavailableError: The model did not answer within the configured patience.
        """
        question = yes_no_question(
            "score view", goal.named_in(self._config.prompt), observation.rgb
        )
        yes = self._asker.ask(question, f"scored {_UNSURE:g}")
        return _UNSURE if yes is None else yes
