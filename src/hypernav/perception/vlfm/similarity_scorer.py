"""Scores by a model that compares images with texts (VLFM's way)."""

from pydantic import Field

from hypernav.core.components.protocols import Similarity
from hypernav.core.config import RoomConfig
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.models.vision.similarity import ImageTextSimilarity, SimilarityConfig


class SimilarityScorerConfig(RoomConfig):
    """The sentence that images are compared with, and the model's use.

    Attributes:
        prompt: Sentence; ``{goal}`` is filled in. It says what VLFM's says, in our words.
        similarity: Device, dtype and head of the model. VLFM takes the cosine of BLIP-2's
            contrastive head.
    """

    prompt: str = "It looks as if a {goal} is close by."
    similarity: SimilarityConfig = Field(default=SimilarityConfig(head="itc"))


class SimilarityScorer:
    """Compares every image with one sentence."""

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
        if isinstance(model, str):
            model = ImageTextSimilarity(model, self._config.similarity)
        self._model = model

    def score(self, observation: Observation, goal: Goal) -> float:
        """Similarity of the image and the sentence, 0 to 1."""
        return self._model.similarity(observation.rgb, goal.named_in(self._config.prompt))
