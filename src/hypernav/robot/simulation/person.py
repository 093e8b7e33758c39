"""A person who steps into the way of a simulated robot."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64
from pydantic import Field

from hypernav.core.config import RoomConfig
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.world import Position, RenderedView, Walkable

_CLOTHES = np.array([186, 74, 58], dtype=np.float64)
_DARKEST = 0.45


class PersonConfig(RoomConfig):
    """How a person steps into the robot's way from the side, stands there, and walks on.

    Attributes:
        radius_m: Radius of the upright cylinder that stands for the person, metres.
        height_m: Its height, metres.
        speed_m_s: Speed of walking, metres per second.
        ahead_m: Least and largest distance before the robot's middle at which the person stops,
            metres.
        aside_m: Distance to the side from which the person comes, metres.
        stands_s: Least and largest time of standing in the way, seconds.
        every_s: Least and largest time between two visits, seconds.
        keeps_m: Gap that the person keeps to the robot, metres: the person never walks into it.
    """

    radius_m: float = Field(default=0.25, gt=0.0, le=1.0)
    height_m: float = Field(default=1.7, gt=0.0, le=3.0)
    speed_m_s: float = Field(default=1.0, gt=0.0, le=3.0)
    ahead_m: tuple[float, float] = (0.8, 1.4)
    aside_m: float = Field(default=1.2, gt=0.0, le=5.0)
    stands_s: tuple[float, float] = (1.0, 4.0)
    every_s: tuple[float, float] = (3.0, 8.0)
    keeps_m: float = Field(default=0.3, ge=0.0, le=2.0)


@dataclass
class _Visit:
    """One walk into the way: points to go to, and how long to stand at the first."""

    points: list[tuple[float, float]]
    stands_s: float


class Person:
    """A person on the floor of a scene, present only during visits.

    Attributes:
        position: Where the person stands ``(x, y)``, scene frame, metres; None while away.
        visits: Number of times that the person has stepped into the way.
    """

    def __init__(self, config: PersonConfig, walkable: Walkable, rng: np.random.Generator) -> None:
        """Create a person who is away."""
        self.config = config
        self._walkable = walkable
        self._rng = rng
        self._away_s = self._between(config.every_s)
        self._visit: _Visit | None = None
        self.position: tuple[float, float] | None = None
        self.visits = 0

    def gap_m(self, robot: Position, radius_m: float) -> float:
        """Distance between the person and the robot's body, metres; infinite while away."""
        if self.position is None:
            return math.inf
        return math.dist(self.position, robot[:2]) - radius_m - self.config.radius_m

    def live(
        self, seconds: float, robot: Pose2, z: float, radius_m: float, *, drives: bool
    ) -> None:
        """Move the person for a time.

        Args:
            seconds: The time.
            robot: True pose of the robot, scene frame.
            z: Height of its floor, metres.
            radius_m: Radius of its body, metres.
            drives: Whether it drives forward; the person only steps into the way of a moving robot.
        """
        if self._visit is None or self.position is None:
            self._away_s -= seconds
            if self._away_s <= 0.0 and drives:
                self._come(robot, z)
            return
        visit = self._visit
        target = visit.points[0]
        step_m, left_m = self.config.speed_m_s * seconds, math.dist(self.position, target)
        if left_m > 1e-6:
            share = min(step_m / left_m, 1.0)
            x = self.position[0] + share * (target[0] - self.position[0])
            y = self.position[1] + share * (target[1] - self.position[1])
            near_m = radius_m + self.config.radius_m + self.config.keeps_m
            comes_nearer = robot.distance_to(x, y) < robot.distance_to(*self.position)
            if not (comes_nearer and robot.distance_to(x, y) < near_m):
                self.position = (x, y)
                return
        visit.stands_s -= seconds
        if visit.stands_s <= 0.0:
            visit.points.pop(0)
            if not visit.points:
                self.position, self._visit = None, None
                self._away_s = self._between(self.config.every_s)

    def _come(self, robot: Pose2, z: float) -> None:
        """Appear beside the robot's way if there is room on both sides of it."""
        config = self.config
        ahead_m = self._between(config.ahead_m)
        side = float(self._rng.choice([-1.0, 1.0]))
        c, s = math.cos(robot.yaw), math.sin(robot.yaw)

        def point(beside_m: float) -> tuple[float, float]:
            return (robot.x + c * ahead_m - s * beside_m, robot.y + s * ahead_m + c * beside_m)

        line = [point(side * share * config.aside_m) for share in np.linspace(1.0, 0.0, 7)]
        if all(self._walkable.is_standable(x, y, z) for x, y in line):
            self.position = line[0]
            self._visit = _Visit([line[-1], line[0]], self._between(config.stands_s))
            self.visits += 1

    def _between(self, bounds: tuple[float, float]) -> float:
        return float(self._rng.uniform(*bounds))


def drawn_into(
    view: RenderedView,
    camera: PinholeCamera,
    camera_to_scene: Transform,
    person: Person,
    floor_z: float,
) -> RenderedView:
    """The view with the person in it: colour, depth and instances.

    Args:
        view: What the camera sees of the scene.
        camera: Intrinsics of the camera.
        camera_to_scene: Pose of the camera.
        person: The person.
        floor_z: Height of the floor that the person stands on, scene frame, metres.
    """
    if person.position is None:
        return view
    rays = camera.rays() @ camera_to_scene.rotation.T
    depth, cosine = _cylinder_depth(rays, camera_to_scene.translation, person, floor_z)
    nearer = (depth < np.where(view.depth > 0.0, view.depth, np.inf)) & np.isfinite(depth)
    shade = _DARKEST + (1.0 - _DARKEST) * cosine[..., None]
    rgb = np.where(nearer[..., None], (_CLOTHES * shade).astype(np.uint8), view.rgb)
    return RenderedView(
        rgb=rgb,
        depth=np.where(nearer, depth, view.depth).astype(np.float32),
        instance_ids=np.where(nearer, np.int32(-1), view.instance_ids),
    )


def _cylinder_depth(
    rays: Float64[np.ndarray, "height width 3"],
    eye: Float64[np.ndarray, "3"],
    person: Person,
    floor_z: float,
) -> tuple[Float64[np.ndarray, "height width"], Float64[np.ndarray, "height width"]]:
    """Depth at which rays hit the side of the cylinder (infinite for a miss), and their angle."""
    assert person.position is not None
    config = person.config
    to_eye = eye[:2] - np.array(person.position)
    a = (rays[..., :2] ** 2).sum(axis=-1)
    b = (rays[..., :2] * to_eye).sum(axis=-1)
    root = b**2 - a * (to_eye @ to_eye - config.radius_m**2)
    with np.errstate(invalid="ignore", divide="ignore"):
        depth = (-b - np.sqrt(root)) / a
        height = eye[2] + depth * rays[..., 2] - floor_z
    hit: Bool[np.ndarray, "height width"] = (
        (root > 0.0) & (depth > 0.0) & (height >= 0.0) & (height <= config.height_m)
    )
    slant = np.sqrt(np.where(hit, root, 0.0) / np.maximum(a, 1e-12)) / config.radius_m
    return np.where(hit, depth, np.inf), np.clip(slant, 0.0, 1.0)
