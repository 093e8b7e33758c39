"""Scores of views: a chat model's yes, the similarity to a text, or true labels in their place."""

import zlib
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float64
from pydantic import Field

from hypernav.core.components.protocols import Similarity
from hypernav.core.config import RoomConfig
from hypernav.core.errors import LabelsMissingError
from hypernav.core.goal import Goal
from hypernav.core.labels import ObjectLabel, canonical
from hypernav.core.observation import Observation
from hypernav.search.models.similarity import ImageTextSimilarity, SimilarityConfig
from hypernav.search.perception.exchanges import YesNoAsker, yes_no_question
from hypernav.search.perception.room_table import RoomTable, room_table

_PROMPT = (
    "You look for a {goal} in a building. Is the place in this picture one from which a {goal} is "
    "likely close by? Answer yes or no."
)
_UNSURE = 0.5
"""Score of a view if the answer is neither yes nor no."""

_STRIDE = 8
"""Every 8th pixel in both directions is read."""
_LEAST_PIXELS = 2
"""Number of these pixels from which a thing counts as in view."""


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


class TruthScorerConfig(RoomConfig):
    """Quality of the stand-in.

    Attributes:
        noise: Standard deviation of the errors that are added to the scores. The same view of the
            same goal always has the same error.
    """

    noise: float = Field(default=0.0, ge=0.0, le=10.0)


@dataclass(frozen=True, eq=False)
class TruthScorer:
    """Scores a view by the chance that a room like the one in view holds the goal.

    The labels of the things in view tell the room; where they name none, the things themselves do,
    by the table of what stands where (`hypernav.search.perception.room_table`).
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
        score = _average(goal) if chance is None else chance
        if self.config.noise > 0.0:
            score += self.config.noise * self._error(observation, goal)
        return min(max(score, 0.0), 1.0)

    def _error(self, observation: Observation, goal: Goal) -> float:
        """The error of this view, standard normal."""
        robot = observation.robot
        pose = [round(number * 1000.0) & 0xFFFFFFFF for number in (robot.x, robot.y, robot.yaw)]
        seed = [0, zlib.crc32(goal.text.encode()), *pose]
        return float(np.random.default_rng(seed).standard_normal())


def chance_in_view(
    observation: Observation, goal: Goal, columns: slice = slice(None)
) -> float | None:
    """Chance that a room like the one in view holds the goal; 1 where the goal is in view.

    Args:
        observation: Present frame.
        goal: Goal of the search.
        columns: Columns of the image that count; all by default.

    Returns:
        0 to 1; None where nothing that tells a room is in view, or the table doesn't know the goal.

    Raises:
        LabelsMissingError: The world supplies no labels.
    """
    truth = observation.truth
    if truth is None:
        raise LabelsMissingError(
            "scoring views by the truth needs a simulated world with labels, and this one supplies "
            "none; choose a real model, for example --reasoner similarity:PATH_OR_ID"
        )
    ids = truth.ids[::_STRIDE, columns][:, ::_STRIDE]
    pixels = np.bincount(ids[ids >= 0])
    shown = {
        truth.labels[number]: int(pixels[number])
        for number in np.flatnonzero(pixels >= _LEAST_PIXELS).tolist()
        if number in truth.labels
    }
    if any(label.satisfies(goal) for label in shown):
        return 1.0
    table = room_table()
    thing = table.of_thing(goal.text)
    rooms = _rooms_in_view(table, shown)
    return None if thing is None or rooms is None else float(rooms @ table.chances[thing])


def _average(goal: Goal) -> float:
    """Chance that an average room holds the goal; 0.5 if the table doesn't know it."""
    thing = room_table().of_thing(goal.text)
    return 0.5 if thing is None else float(room_table().chances[thing].mean())


def _rooms_in_view(
    table: RoomTable, shown: dict[ObjectLabel, int]
) -> Float64[np.ndarray, " kinds"] | None:
    """Probability of each kind of room, by the things in view; None if these tell nothing."""
    rooms = np.zeros(len(table.kinds))
    for label, pixels in shown.items():
        number = table.numbers.get(canonical(label.room)) if label.room else None
        if number is not None:
            rooms[number] += pixels
    if not rooms.any():
        things = sorted({name for one in shown if (name := table.of_thing(one.category))})
        if not things:
            return None
        rooms = np.exp(sum(np.log(table.chances[thing]) for thing in things))
    return rooms / rooms.sum()
