"""The protocols between the rooms of this package, and for your own code."""

from collections.abc import Sequence
from typing import Any, Protocol, runtime_checkable

import numpy as np
from jaxtyping import Bool, Float32

from hypernav.core.chat import Answer, Image, Question
from hypernav.core.embodiment import Action
from hypernav.core.exploring.exploration import (
    Destination,
    ExplorationView,
    StairsDestination,
)
from hypernav.core.exploring.guidance import ArrowChoice, ArrowView, GuideChoice, GuideView
from hypernav.core.exploring.overview import BlockChoice, Overview
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import StepTrace


@runtime_checkable
class Agent(Protocol):
    """The agent: finds a goal, one action at a time. It knows no simulator."""

    def reset(self, goal: Goal) -> None:
        """Forget everything and begin a new search."""
        ...

    def act(self, observation: Observation) -> Action | None:
        """Look, decide, and say what to do next.

        Returns:
            The action. STOP ends the search with the claim that the goal is here. None ends it
            without that claim: the agent gives up.
        """
        ...


@runtime_checkable
class Remembers(Agent, Protocol):
    """An agent that keeps what it knows of a building, and can take it up again."""

    @property
    def memory(self) -> Any:
        """What it knows, the present search included; there is none before the first one."""
        ...

    def reset(self, goal: Goal, memory: Any = None) -> None:
        """Begin a new search with what is known of the building; None if nothing is."""
        ...


@runtime_checkable
class ExplainsItself(Protocol):
    """An agent that keeps a trace of its last step, for videos, pages and analysis."""

    @property
    def last_step(self) -> StepTrace:
        """The trace of the latest `act`."""
        ...

    @property
    def grid(self) -> OccupancyGrid:
        """The map drawn so far."""
        ...


@runtime_checkable
class Detector(Protocol):
    """Finds the goal in an image."""

    def detect(self, observation: Observation, goal: Goal) -> list[Detection]:
        """All candidates, the likeliest by the detector's own judgement first, whatever the scores.

        Where two boxes show one thing, or one alone is wanted, the first counts. An empty list if
        the goal is not seen.
        """
        ...


@runtime_checkable
class Segmenter(Protocol):
    """Finds the pixels of the object in a box."""

    def segment(self, observation: Observation, box: Box) -> Bool[np.ndarray, "height width"]:
        """Mask of the object's pixels; all False if the box holds none."""
        ...


@runtime_checkable
class BlockReasoner(Protocol):
    """Chooses the part of the map to visit next."""

    def choose(self, overview: Overview, goal: Goal, excluded: frozenset[int]) -> BlockChoice:
        """Choice of a block that is not excluded, or of none if none is worth a visit."""
        ...


@runtime_checkable
class ArrowReasoner(Protocol):
    """Chooses among moves that are drawn into the camera image."""

    def choose(self, view: ArrowView, goal: Goal) -> ArrowChoice:
        """The best moves, or none if the answer names none."""
        ...


@runtime_checkable
class Guide(Protocol):
    """Says which part of the camera image leads to the goal, if any does."""

    def direct(self, view: GuideView, goal: Goal) -> GuideChoice:
        """The direction, or that there is none."""
        ...


@runtime_checkable
class SceneScorer(Protocol):
    """Scores how likely it is, by the camera image, that the goal is near."""

    def score(self, observation: Observation, goal: Goal) -> float:
        """Score from 0 (not at all) to 1; comparable only between answers of one scorer."""
        ...


@runtime_checkable
class Explorer(Protocol):
    """Chooses where to go while the goal is out of sight.

    It is given one view and keeps nothing that the memory has. It keeps its own notes in
    `ExplorationView.notes`.
    """

    def next_destination(self, view: ExplorationView) -> Destination | StairsDestination | None:
        """The next position to visit, or None if nothing is left to explore."""
        ...


@runtime_checkable
class PresenceCheck(Protocol):
    """The last look at the goal before the robot declares success."""

    def is_present(self, observation: Observation, goal: Goal) -> bool:
        """Whether the goal is really in the image."""
        ...


@runtime_checkable
class ChatModel(Protocol):
    """A model that looks at images and answers in words. Safe to share between threads."""

    def identify(self) -> str:
        """The model's name, requested from the server if necessary; it contains no secret.

        Raises:
            ModelUnavailableError: The server does not give the name within the configured patience.
        """
        ...

    def ask(self, question: Question) -> Answer:
        """The answer, parsed and checked; ``fault`` says why it cannot be used, if so.

        Raises:
            ModelUnavailableError: The model did not answer within the configured patience.
        """
        ...


@runtime_checkable
class Similarity(Protocol):
    """A measure of how well a text fits an image."""

    def similarity(self, image: Image, text: str) -> float:
        """Similarity from 0 (none at all) to 1; comparable only between answers of one model."""
        ...


@runtime_checkable
class ImageTextModel(Protocol):
    """Vectors of images and of texts: the smaller the angle of two, the better they fit.

    That of an image depends on no text, so that it can be kept for the next goal.
    """

    def image_vectors(self, image: Image) -> Float32[np.ndarray, "n size"]:
        """Vectors of an image (RGB), none of length 0; the one counts that fits a text best."""
        ...

    def text_vectors(self, texts: Sequence[str]) -> Float32[np.ndarray, "texts size"]:
        """Vector of each text, none of length 0."""
        ...
