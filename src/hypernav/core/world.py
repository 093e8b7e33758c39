"""What a world is to those who run an episode in it, and what its truth is to those who measure.

A simulated scene, Habitat and a robot are each one class that keeps the contract of `World`. Agents
see none of this: they get observations.
"""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float32, Float64, Int32, UInt8

from hypernav.core.actions import Action
from hypernav.core.episode import Episode
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Transform
from hypernav.core.goal import Goal
from hypernav.core.labels import ObjectLabel
from hypernav.core.observation import Observation


@dataclass(frozen=True)
class Instance:
    """One thing of a scene.

    Attributes:
        id: Number of the thing in images of instances, equal to its place among all instances.
        name: Unique within the scene.
        label: What it is; None for walls, floors and ceilings, which nobody searches for.
        box_min: Lowest corner of its axis-aligned box, scene frame, metres.
        box_max: Highest corner.
    """

    id: int
    name: str
    label: ObjectLabel | None
    box_min: tuple[float, float, float]
    box_max: tuple[float, float, float]


@runtime_checkable
class Walkable(Protocol):
    """The truth about the floor, in the scene's frame, metres."""

    def is_standable(self, x: float, y: float) -> bool:
        """Whether the robot fits here."""
        ...

    def step(self, x: float, y: float, dx: float, dy: float) -> tuple[float, float]:
        """Where a straight move ends: at its target, or at the last standable point before it."""
        ...

    def distance(self, start: tuple[float, float], end: tuple[float, float]) -> float:
        """Geodesic distance, metres; infinite if no path exists."""
        ...

    def component_of(self, x: float, y: float) -> int:
        """The connected part that a point lies in: 0 is the largest, -1 is not standable."""
        ...

    def centres(self, component: int = 0) -> Float64[np.ndarray, "n 2"]:
        """Points that are spread evenly over one connected part."""
        ...

    def random_point(self, rng: np.random.Generator) -> tuple[float, float]:
        """A standable point, uniform over the area."""
        ...


@runtime_checkable
class GoalTruth(Protocol):
    """Where a goal counts as reached, in the scene's frame, metres."""

    @property
    def goal(self) -> Goal:
        """What was asked for."""
        ...

    @property
    def instances(self) -> tuple[Instance, ...]:
        """What satisfies it; empty if the scene holds no such thing."""
        ...

    @property
    def view_points(self) -> Float64[np.ndarray, "n 3"]:
        """Points on the floor where it counts as reached; empty if there are none."""
        ...

    def distance(self, x: float, y: float) -> float:
        """Geodesic distance to the nearest view point; infinite if there is no way."""
        ...


@runtime_checkable
class SceneTruth(Protocol):
    """What only measuring and failure analysis may ask a world for. Scene frame, metres."""

    @property
    def instances(self) -> tuple[Instance, ...]:
        """Everything that the scene consists of, with labels."""
        ...

    @property
    def walkable(self) -> Walkable:
        """Where the robot can stand."""
        ...

    @property
    def position(self) -> tuple[float, float, float]:
        """Where the robot really is, on the floor."""
        ...

    @property
    def map_to_scene(self) -> Transform:
        """From the ``map`` frame of the present episode to the scene's."""
        ...

    def goal_truth(
        self, goal: Goal, view_points: Float64[np.ndarray, "n 3"] | None = None
    ) -> GoalTruth:
        """Where a goal counts as reached.

        Args:
            goal: What is looked for.
            view_points: The data set's own view points; None computes those of the scene.
        """
        ...


@runtime_checkable
class World(Protocol):
    """Anything that yields observations and takes actions: a simulated scene, Habitat, a robot."""

    @property
    def is_over(self) -> bool:
        """Whether no further action is taken: after STOP, or when the world ended by itself."""
        ...

    @property
    def collided(self) -> bool:
        """Whether something was in the way of the latest action."""
        ...

    @property
    def truth(self) -> SceneTruth | None:
        """The truth about the scene; None where nobody knows it."""
        ...

    def reset(self, episode: Episode, rng: np.random.Generator | None = None) -> Observation:
        """Begin an episode.

        Args:
            episode: Its start is where the robot is placed; a robot stays where it is.
            rng: Source of all noise; needed only if noise is switched on.

        Returns:
            The first observation; its robot pose is the origin of the ``map`` frame.

        Raises:
            StartError: The robot can't stand at the start.
        """
        ...

    def step(self, action: Action) -> Observation:
        """Do something and look. STOP ends the episode.

        Raises:
            WorldError: Before the first `reset`, or after the end.
        """
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
