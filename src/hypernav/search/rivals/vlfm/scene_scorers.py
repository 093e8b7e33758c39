"""Scores of views: a chat model's yes, the similarity to a text, or true labels in their place."""

import zlib
from dataclasses import dataclass, field

import numpy as np

from hypernav.core.components.protocols import Similarity
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.search.models.config import SimilarityScorerConfig
from hypernav.search.models.similarity import load_similarity
from hypernav.search.perception.exchanges import YesNoAsker, yes_no_question
from hypernav.search.rivals.config import ChatScorerConfig, TruthScorerConfig
from hypernav.search.rivals.room_table import average_chance, chance_in_view

_UNSURE = 0.5
"""Score of a view if the answer is neither yes nor no."""


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
                `hypernav.search.models.similarity.ImageTextSimilarity`.
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


@dataclass(frozen=True, eq=False)
class TruthScorer:
    """Scores a view by the chance that a room like the one in view holds the goal.

    The labels of the things in view tell the room; where they name none, the things themselves do,
    by the table of what stands where (`hypernav.search.rivals.room_table`).
    Where the goal itself is in view the score is 1. It shows what a value map is worth if images
    are scored well; with noise, how well they must be. Ours; nothing like it was published.

    Attributes:
        config: Quality of the stand-in.
        looks_at_colours: See `hypernav.core.components.abilities.looks_at_colours`.
        stands_in_for: What it is used in place of, and the remedy, for people.
    """

    config: TruthScorerConfig = field(default_factory=TruthScorerConfig)

    looks_at_colours = False
    stands_in_for = (
        "a model that compares images with texts (--reasoner similarity:PATH_OR_ID, or --vlm)"
    )

    def score(self, observation: Observation, goal: Goal) -> float:
        """Chance of the goal in a room like the one in view, 0 to 1.

        Raises:
            LabelsMissingError: The world supplies no labels.
        """
        chance = chance_in_view(observation, goal)
        score = average_chance(goal) if chance is None else chance
        if self.config.noise > 0.0:
            score += self.config.noise * self._error(observation, goal)
        return min(max(score, 0.0), 1.0)

    def _error(self, observation: Observation, goal: Goal) -> float:
        """The error of this view, standard normal."""
        robot = observation.robot
        pose = [round(number * 1000.0) & 0xFFFFFFFF for number in (robot.x, robot.y, robot.yaw)]
        seed = [0, zlib.crc32(goal.text.encode()), *pose]
        return float(np.random.default_rng(seed).standard_normal())
