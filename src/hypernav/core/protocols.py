"""The seams: small contracts between the rooms of this package and with code of your own."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Bool, Float32, Int32, UInt8

from hypernav.core.actions import Action
from hypernav.core.chat import Answer, Image, Question
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Transform
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.overview import BlockChoice, Overview
from hypernav.core.trace import StepTrace


@runtime_checkable
class Agent(Protocol):
    """Finds a goal, one action at a time. Knows no simulator."""

    def reset(self, goal: Goal) -> None:
        """Forget everything and begin a new search."""
        ...

    def act(self, observation: Observation) -> Action | None:
        """Look, decide, and say what to do next.

        Returns:
            The action. STOP ends the search and says "here it is". None ends it without that
            claim: the agent gives up.
        """
        ...


@runtime_checkable
class ExplainsItself(Protocol):
    """An agent that can say what it did in its last step, for videos, pages and analysis."""

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
    """Sees whether the goal is in the image."""

    def detect(self, observation: Observation, goal: Goal) -> list[Detection]:
        """All candidates, best first. An empty list means: not seen."""
        ...


@runtime_checkable
class Segmenter(Protocol):
    """Finds the pixels of the object in a box."""

    def segment(self, observation: Observation, box: Box) -> Bool[np.ndarray, "height width"]:
        """The object's pixels; all False if the box holds none."""
        ...


@runtime_checkable
class BlockReasoner(Protocol):
    """Chooses the part of the map to visit next."""

    def choose(self, overview: Overview, goal: Goal, excluded: frozenset[int]) -> BlockChoice:
        """One of the blocks that are not excluded, or None if nothing is worth a visit."""
        ...


@runtime_checkable
class PresenceCheck(Protocol):
    """Looks once more, at the goal, before the robot declares success."""

    def is_present(self, observation: Observation, goal: Goal) -> bool:
        """Whether the goal is really in the image."""
        ...


@runtime_checkable
class ChatModel(Protocol):
    """A model that looks at images and answers in words. Safe to share between threads."""

    def identify(self) -> str:
        """The model's name, found out if need be. Holds no secret.

        Raises:
            ModelUnavailableError: It cannot be found out within the configured patience.
        """
        ...

    def ask(self, question: Question) -> Answer:
        """The answer, read and checked; one that cannot be used says so in its ``fault``.

        Raises:
            ModelUnavailableError: The model stayed away for longer than the configured patience.
        """
        ...


@runtime_checkable
class Similarity(Protocol):
    """Tells how well a text fits an image."""

    def similarity(self, image: Image, text: str) -> float:
        """From 0 (not at all) to 1; comparable only between answers of the same model."""
        ...


@dataclass(frozen=True, eq=False)
class RenderedView:
    """What a simulated camera sees.

    Attributes:
        rgb: Colour.
        depth: Metres along the optical axis, 0 where nothing was hit. Not cut to a sensor's range.
        instance_ids: Instance of every pixel, -1 where nothing was hit.
    """

    rgb: UInt8[np.ndarray, "height width 3"]
    depth: Float32[np.ndarray, "height width"]
    instance_ids: Int32[np.ndarray, "height width"]


@runtime_checkable
class Renderer(Protocol):
    """Draws a scene."""

    def render(self, camera: PinholeCamera, camera_to_scene: Transform) -> RenderedView:
        """Colour, depth and instances as seen from a pose in the scene's frame."""
        ...


@runtime_checkable
class Walkable(Protocol):
    """The simulator's truth about the floor, in the scene's frame."""

    def is_standable(self, x: float, y: float) -> bool:
        """Whether the robot fits here."""
        ...

    def step(self, x: float, y: float, dx: float, dy: float) -> tuple[float, float]:
        """Where a straight move ends: at its target, or at the last standable point before it."""
        ...

    def distance(self, start: tuple[float, float], end: tuple[float, float]) -> float:
        """Geodesic distance, metres; infinite if no path exists."""
        ...

    def random_point(self, rng: np.random.Generator) -> tuple[float, float]:
        """A standable point, uniform over the area."""
        ...
