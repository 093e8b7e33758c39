"""Scores of views by models: the probability of a chat model's yes, or similarity to a text."""

from dataclasses import dataclass, field

from pydantic import Field

from hypernav.core.components.protocols import Similarity
from hypernav.core.config import RoomConfig
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.models.vision.similarity import ImageTextSimilarity, SimilarityConfig
from hypernav.perception.exchanges import YesNoAsker, yes_no_question

_PROMPT = (
    "You look for a {goal} in a building. Is the place in this picture one from which a {goal} is "
    "likely close by? Answer yes or no."
)
_UNSURE = 0.5
"""Score of a view if the answer is neither yes nor no."""


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


class SimilarityScorerConfig(RoomConfig):
    """The sentence that images are compared with, and the model's use.

    Attributes:
        prompt: Sentence; ``{goal}`` is filled in. In substance VLFM's, in our words.
        similarity: Device, dtype and head of the model. VLFM takes the cosine of BLIP-2's
            contrastive head.
    """

    prompt: str = "It looks as if a {goal} is close by."
    similarity: SimilarityConfig = Field(default=SimilarityConfig(head="itc"))


def load_similarity(path: str, config: SimilarityScorerConfig | None = None) -> ImageTextSimilarity:
    """Load a model that compares images with texts.

    Args:
        path: A folder, or the id of a model in the local Hugging Face cache.
        config: Use of the model; the sentence is for scores of views.

    Raises:
        MissingExtraError: torch or transformers is not installed.
        ModelError: There are no such weights, or they compare nothing.
    """
    return ImageTextSimilarity(path, (config or SimilarityScorerConfig()).similarity)


class SimilarityScorer:
    """Scores a view by the similarity of its image and one sentence about the goal."""

    def __init__(
        self,
        model: str | Similarity,
        config: SimilarityScorerConfig | None = None,
    ) -> None:
        """Create the scorer.

        Args:
            model: Model, or folder or id of one for
                `hypernav.models.vision.similarity.ImageTextSimilarity`.
            config: Sentence and use of the model.

        Raises:
            MissingExtraError: torch or transformers is not installed.
            ModelError: There are no such weights, or they compare nothing.
        """
        self._config = config or SimilarityScorerConfig()
        self._model = load_similarity(model, self._config) if isinstance(model, str) else model

    def score(self, observation: Observation, goal: Goal) -> float:
        """Similarity of the image and the sentence, 0 to 1."""
        return self._model.similarity(observation.rgb, goal.named_in(self._config.prompt))
