"""The contract of a world in which episodes run, and of the ground truth for measures.

A simulated scene, Habitat and a robot are each one class that implements `World`. Agents see none
of this: they get observations.
"""

from collections.abc import Collection
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float32, Float64, Int32, UInt8

from hypernav.core.embodiment import Action, Embodiment
from hypernav.core.episode import Episode
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel
from hypernav.core.observation import Observation


@dataclass(frozen=True)
class Instance:
    """One object of a scene.

    Attributes:
        id: Number of the instance in images of instances, its index among all instances.
        name: Name that is unique within the scene.
        label: Label of the object; None for walls, floors and ceilings, which nobody searches for.
        box_min: Lowest corner of its axis-aligned box, scene frame, metres.
        box_max: Highest corner of the same box.
    """

    id: int
    name: str
    label: ObjectLabel | None
    box_min: tuple[float, float, float]
    box_max: tuple[float, float, float]


Position = tuple[float, float, float]
"""Position ``(x, y, z)`` of the robot on a floor, scene frame, metres."""


@runtime_checkable
class Walkable(Protocol):
    """The true walkable surface, scene frame, metres.

    One floor may lie above another: ``z`` is the approximate height of the floor that is meant;
    without it, that of the main storey. A surface of one storey ignores it.
    """

    def height_at(self, x: float, y: float, z: float | None = None) -> float:
        """Height of the floor; NaN where the robot can't stand."""
        ...

    def is_standable(self, x: float, y: float, z: float | None = None) -> bool:
        """Whether the robot fits here."""
        ...

    def nearest_standable(self, x: float, y: float, z: float | None = None) -> Position:
        """The nearest position where the robot fits."""
        ...

    def move(self, position: Position, dx: float, dy: float, *, sliding: bool = False) -> Position:
        """End of a straight move.

        Args:
            position: Where the robot is.
            dx: Wanted displacement along x, metres.
            dy: Wanted displacement along y, metres.
            sliding: Whether it slides along obstacles; by default it stops at the contact.
        """
        ...

    def component_of(self, x: float, y: float, z: float | None = None) -> int:
        """Number of the connected part around a point: 0 is the largest; -1 if not standable."""
        ...

    def centres(self, component: int = 0) -> Float64[np.ndarray, "n 2"]:
        """Evenly spaced points of one connected part."""
        ...

    def random_point(self, rng: np.random.Generator) -> tuple[float, float]:
        """A standable point of the largest part, on the main storey, uniform over the area."""
        ...


@runtime_checkable
class GoalTruth(Protocol):
    """Instances and view points of a goal, in the scene's frame, metres."""

    @property
    def goal(self) -> Goal:
        """The goal."""
        ...

    @property
    def instances(self) -> tuple[Instance, ...]:
        """Instances that satisfy the goal; empty if the scene holds none."""
        ...

    @property
    def view_points(self) -> Float64[np.ndarray, "n 3"]:
        """Points on the floor where the goal counts as reached; empty if there are none."""
        ...

    def distance(self, x: float, y: float, z: float | None = None) -> float:
        """Geodesic distance to the nearest view point; infinite if no path exists."""
        ...


@dataclass(frozen=True, eq=False)
class RenderedView:
    """Images of a simulated camera.

    Attributes:
        rgb: Colour image.
        depth: Depth image, metres along the optical axis; 0 where nothing was hit. Not clipped to
            a sensor's range.
        instance_ids: Instance of every pixel, -1 where nothing was hit.
    """

    rgb: UInt8[np.ndarray, "height width 3"]
    depth: Float32[np.ndarray, "height width"]
    instance_ids: Int32[np.ndarray, "height width"]


@runtime_checkable
class KeepsMapFrame(Protocol):
    """A world that can give the observations of several episodes in one ``map`` frame."""

    def keep_map_frame(self, map_to_scene: Transform | None) -> None:
        """Keep a frame from the next `World.reset` on; None begins one at every start."""
        ...


@runtime_checkable
class HasSurfaces(Protocol):
    """Whatever knows the surfaces of a scene's instances."""

    def triangles_of(self, ids: Collection[int]) -> Float64[np.ndarray, "n 3 3"]:
        """The triangles of some instances, scene frame, metres."""
        ...


@runtime_checkable
class SceneTruth(HasSurfaces, Protocol):
    """The truth about a scene, for measuring and failure analysis only. Scene frame, metres."""

    @property
    def name(self) -> str:
        """Name of the scene."""
        ...

    @property
    def instances(self) -> tuple[Instance, ...]:
        """All instances of the scene, with labels; an instance's id is its index."""
        ...

    @property
    def walkable(self) -> Walkable:
        """The surface that the robot can stand on."""
        ...

    @property
    def pose(self) -> Pose2:
        """True pose of the robot on the floor plan."""
        ...

    @property
    def position(self) -> Position:
        """True position of the robot on the floor."""
        ...

    @property
    def camera_to_scene(self) -> Transform:
        """True pose of the camera."""
        ...

    @property
    def map_to_scene(self) -> Transform:
        """Transform from the ``map`` frame of the present episode to the scene's frame."""
        ...

    def goals(self) -> tuple[str, ...]:
        """Categories of the objects that can be reached, sorted."""
        ...

    def goal_truth(
        self, goal: Goal, view_points: Float64[np.ndarray, "n 3"] | None = None
    ) -> GoalTruth:
        """Instances and view points of a goal.

        Args:
            goal: Target of the search.
            view_points: The data set's own view points; None computes those of the scene.
        """
        ...

    def random_start(
        self,
        rng: np.random.Generator,
        goal: Goal | None = None,
        *,
        nearest_m: float = 2.0,
        farthest_m: float = 30.0,
    ) -> Pose2:
        """A start pose on the main storey, from which a goal can be reached if there is one.

        Args:
            rng: Random generator of the pose.
            goal: The goal; None draws any start.
            nearest_m: Smallest geodesic distance to the goal.
            farthest_m: Largest geodesic distance to the goal.

        Raises:
            StartError: The robot can stand nowhere.
        """
        ...

    def view_points_of(self, instance: Instance) -> Float64[np.ndarray, "n 3"]:
        """Points on the floor where the robot has reached one object; empty if there are none."""
        ...

    def view_from(
        self,
        camera_to_scene: Transform,
        camera: PinholeCamera | None = None,
        *,
        colours: bool = True,
    ) -> RenderedView:
        """What a camera sees from a pose, without noise.

        Args:
            camera_to_scene: Pose of the optical frame.
            camera: Intrinsics; None takes the robot's.
            colours: Whether the image is drawn; without, it is black.
        """
        ...


@runtime_checkable
class World(Protocol):
    """Anything that yields observations and takes actions: a simulated scene, Habitat, a robot."""

    @property
    def embodiment(self) -> Embodiment:
        """The robot; an agent that was built for another one is refused."""
        ...

    @property
    def is_over(self) -> bool:
        """Whether no further action is possible: after STOP, or when the world ended by itself."""
        ...

    @property
    def collided(self) -> bool:
        """Whether an obstacle blocked the latest action."""
        ...

    @property
    def truth(self) -> SceneTruth | None:
        """The truth about the scene; None if it is unknown."""
        ...

    def reset(self, episode: Episode, rng: np.random.Generator | None = None) -> Observation:
        """Begin an episode.

        Args:
            episode: Episode with the start of a simulated robot; a real robot stays where it is.
            rng: Source of all noise; needed only if noise is switched on.

        Returns:
            The first observation; its robot pose is the origin of the ``map`` frame.

        Raises:
            StartError: The robot can't stand at the start.
        """
        ...

    def step(self, action: Action) -> Observation:
        """Carry out an action and look. STOP ends the episode.

        Raises:
            WorldError: Before the first `reset`, or after the end.
        """
        ...


@runtime_checkable
class Simulator(World, Protocol):
    """A world of which everything is known."""

    @property
    def colours(self) -> bool:
        """Whether observations have colours. May be set: black images are drawn faster."""
        ...

    @colours.setter
    def colours(self, wanted: bool) -> None: ...

    @property
    def truth(self) -> SceneTruth:
        """The truth about the scene."""
        ...

    def close(self) -> None:
        """Release what the world holds; it is not used afterwards."""
        ...


@runtime_checkable
class TiltsCamera(Protocol):
    """A world whose camera can look up and down, as for habitat-lab's actions."""

    def tilt(self, angle_deg: float) -> Observation:
        """Tilt the camera and observe; `World.reset` turns it back.

        Args:
            angle_deg: Angle by which it looks further down, degrees; negative looks up.
        """
        ...


@runtime_checkable
class GoesOn(Protocol):
    """A world in which a robot can begin another search where it stands."""

    def go_on(self, episode: Episode) -> Observation:
        """Begin a further episode of a life: the robot stays, and so does its ``map`` frame.

        Returns:
            The first observation.

        Raises:
            WorldError: Before the first `World.reset`.
        """
        ...


@runtime_checkable
class Renderer(Protocol):
    """A renderer of one scene.

    Attributes:
        colours: Whether images are drawn; without, they are black.
    """

    colours: bool

    def render(self, camera: PinholeCamera, camera_to_scene: Transform) -> RenderedView:
        """Colour, depth and instances as seen from a pose in the scene's frame."""
        ...
