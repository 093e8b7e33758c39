"""Scores by a chat model: how probable its yes is. Ours; VLFM compares image and text."""

from dataclasses import dataclass, field

from hypernav.core.config import RoomConfig
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
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


@dataclass(eq=False)
class ChatScorer(YesNoAsker):
    """Asks whether the goal is likely near, and takes the probability of yes for the score.

    A model that tells no probabilities gives 1 or 0.

    Attributes:
        config: Configuration of the question.
    """

    config: ChatScorerConfig = field(default_factory=ChatScorerConfig)

    count_name = "unsure_scores"

    def score(self, observation: Observation, goal: Goal) -> float:
        """Probability of yes, 0 to 1.

        Raises:
            ModelUnavailableError: The model did not answer within the configured patience.
        """
        question = yes_no_question("score view", goal.named_in(self.config.prompt), observation.rgb)
        yes = self.ask(question, f"scored {_UNSURE:g}")
        return _UNSURE if yes is None else yes
