"""Goal regions: positions from which a goal counts as reached, distances to them, and starts.

The view points of an object are defined as by Habitat's ObjectNav: standable points within 1.0 m
(horizontal) of the object's axis-aligned box from which the object is really visible. Habitat
counts object pixels in images taken from the point with the camera turned to the object; here rays
go from the camera's height to points on the object's surface, and one must hit the object first.
As in Habitat, the camera's direction and vertical field of view don't matter.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32, Float64

from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.world import Instance
from hypernav.simulator.worlds.drawing.rays import RayCaster
from hypernav.simulator.worlds.scenes.scene import Scene
from hypernav.simulator.worlds.surface.walkable_surface import PathField, WalkableSurface

REACH_M = 1.0
EYE_HEIGHT_M = 0.88

_SURFACE_POINTS = 128
_ROUNDS = (4, 12, 32, 80)
"""Number of surface points tried at a time; most view points see one of the first."""
_DRAWS = 2000


def view_points(
    scene: Scene,
    walkable: WalkableSurface,
    instance: Instance,
    rays: RayCaster,
    *,
    reach_m: float = REACH_M,
    eye_height_m: float = EYE_HEIGHT_M,
) -> Float64[np.ndarray, "n 3"]:
    """Positions from which an object counts as reached.

    Every cell of the largest connected part of the walkable surface is tried, so the points are one
    cell (5 cm) apart.

    Args:
        scene: Scene that holds the object.
        walkable: Walkable surface of the scene.
        instance: Object to reach.
        rays: Ray caster of the scene.
        reach_m: Greatest horizontal distance to the object's box.
        eye_height_m: Height of the camera above the floor.

    Returns:
        Points on the floor, metres, scene frame; empty if the object is not visible from anywhere.
    """
    floor = walkable.floor_near(instance.box_min, instance.box_max, reach_m)
    eyes = floor + np.array([0.0, 0.0, eye_height_m])
    return floor[_sees(scene, instance, eyes, rays)]


def _sees(
    scene: Scene, instance: Instance, eyes: Float64[np.ndarray, "n 3"], rays: RayCaster
) -> Bool[np.ndarray, "n"]:
    """Whether an object is visible from each eye."""
    surface = surface_points(scene, instance, _SURFACE_POINTS)
    seen = np.zeros(len(eyes), dtype=bool)
    first = 0
    for count in _ROUNDS:
        targets = surface[first : first + count]
        first += count
        waiting = np.flatnonzero(~seen)
        if len(waiting) == 0 or len(targets) == 0:
            break
        origins = np.repeat(eyes[waiting].astype(np.float32), len(targets), axis=0)
        directions = np.tile(targets, (len(waiting), 1)) - origins
        met = rays.instances(origins, directions) == instance.id
        seen[waiting] = met.reshape(len(waiting), len(targets)).any(axis=1)
    return seen


def surface_points(scene: Scene, instance: Instance, count: int) -> Float32[np.ndarray, "n 3"]:
    """Points spread evenly over an object's surface, the same on every call.

    The first few are spread as evenly as all of them. Empty if the object has no triangles.
    """
    corners = scene.vertices[scene.faces[scene.face_instance == instance.id]].astype(np.float64)
    if len(corners) == 0:
        return np.zeros((0, 3), dtype=np.float32)
    sides = corners[:, 1:] - corners[:, :1]
    areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) / 2.0
    # Objects may have only triangles without area, for example lines.
    shares = np.cumsum(areas if areas.sum() > 0.0 else np.ones(len(areas)))
    # Multiples of the three-dimensional golden ratio, modulo 1, are spread evenly for any number.
    golden = 1.2207440846057596
    along, u, v = (0.5 + np.arange(1, count + 1)[:, None] / golden ** np.arange(1, 4)).T % 1.0
    chosen = np.minimum(np.searchsorted(shares, along * shares[-1]), len(corners) - 1)
    folded = u + v > 1.0
    u, v = np.where(folded, 1.0 - u, u), np.where(folded, 1.0 - v, v)
    points = corners[chosen, 0] + u[:, None] * sides[chosen, 0] + v[:, None] * sides[chosen, 1]
    return points.astype(np.float32)


@dataclass(frozen=True, eq=False)
class GoalRegion:
    """The view points of everything that satisfies a goal.

    Attributes:
        goal: Goal that was asked for.
        instances: Objects that satisfy the goal; empty if the scene holds none.
        view_points: Points on the floor, metres, scene frame; empty if none can be reached.
        field: Shortest paths to the nearest view point.
    """

    goal: Goal
    instances: tuple[Instance, ...]
    view_points: Float64[np.ndarray, "n 3"]
    field: PathField

    @staticmethod
    def of_points(
        goal: Goal,
        walkable: WalkableSurface,
        points: Float64[np.ndarray, "n 3"],
        instances: tuple[Instance, ...] = (),
    ) -> "GoalRegion":
        """A region of given view points; their order and repetitions don't matter.

        Points off the surface belong to it, but no path leads to them.
        """
        points = np.unique(points, axis=0)
        return GoalRegion(goal, instances, points, walkable.goal_field(points))

    @property
    def is_reachable(self) -> bool:
        """Whether there is a view point at all."""
        return len(self.view_points) > 0

    def distance(self, x: float, y: float, z: float | None = None) -> float:
        """Geodesic distance to the nearest view point, metres; infinite if no path leads there."""
        return self.field.distance(x, y, z)


class GoalRegions:
    """Goal regions of one scene; the view points of an object are computed once, when needed."""

    def __init__(
        self,
        scene: Scene,
        walkable: WalkableSurface,
        rays: RayCaster,
        *,
        reach_m: float = REACH_M,
        eye_height_m: float = EYE_HEIGHT_M,
    ) -> None:
        """Create it for a scene.

        Args:
            scene: Scene that holds the objects.
            walkable: Walkable surface of the scene.
            rays: Ray caster of the scene.
            reach_m: Greatest horizontal distance of a view point to its object's box.
            eye_height_m: Height of the camera above the floor.
        """
        self._scene = scene
        self._walkable = walkable
        self._rays = rays
        self._reach_m = reach_m
        self._eye_height_m = eye_height_m
        self._of_instance: dict[int, Float64[np.ndarray, "n 3"]] = {}

    def of(
        self,
        goal: Goal,
        points: Float64[np.ndarray, "n 3"] | None = None,
        instances: Sequence[Instance] | None = None,
    ) -> GoalRegion:
        """The region of a goal; empty if nothing satisfies the goal.

        Args:
            goal: What is looked for.
            points: View points of a data set, used in place of the scene's own.
            instances: The scene's instances with further names of a data set, if it has any.
        """
        named = tuple(
            instance
            for instance in (self._scene.instances if instances is None else instances)
            if instance.label is not None and instance.label.satisfies(goal)
        )
        if points is None:
            parts = [self.view_points(instance) for instance in named]
            points = np.concatenate([np.zeros((0, 3)), *parts])
        return GoalRegion.of_points(goal, self._walkable, points, named)

    def view_points(self, instance: Instance) -> Float64[np.ndarray, "n 3"]:
        """The view points of one object."""
        if instance.id not in self._of_instance:
            self._of_instance[instance.id] = view_points(
                self._scene,
                self._walkable,
                instance,
                self._rays,
                reach_m=self._reach_m,
                eye_height_m=self._eye_height_m,
            )
        return self._of_instance[instance.id]

    def categories(self) -> tuple[str, ...]:
        """Categories of the scene's objects that have a view point, sorted."""
        return tuple(
            sorted(
                {
                    instance.label.category
                    for instance in self._scene.instances
                    if instance.label is not None and len(self.view_points(instance)) > 0
                }
            )
        )


def random_start(
    walkable: WalkableSurface,
    rng: np.random.Generator,
    region: GoalRegion | None = None,
    *,
    nearest_m: float = 2.0,
    farthest_m: float = 30.0,
    z: float | None = None,
) -> Pose2:
    """A start pose from which a goal can be reached.

    Args:
        walkable: Where the robot can stand.
        rng: Random generator of the pose.
        region: Region of the goal; without one (or if no path leads to it) any start is possible.
        nearest_m: Smallest geodesic distance to the goal.
        farthest_m: Largest geodesic distance to the goal.
        z: Height of the floor that `walkable` draws from, metres; None means its main storey.

    Returns:
        A uniformly drawn pose of the largest connected part with a geodesic distance in the range;
        if none is found, the farthest pose that was drawn.

    Raises:
        StartError: The walkable surface is empty.
    """
    best, best_distance = walkable.random_point(rng), -math.inf
    if region is not None and region.is_reachable:
        for _ in range(_DRAWS):
            point = walkable.random_point(rng)
            distance = region.distance(*point, z)
            if nearest_m <= distance <= farthest_m:
                best = point
                break
            if math.isfinite(distance) and distance > best_distance:
                best, best_distance = point, distance
    return Pose2(*best, float(rng.uniform(-math.pi, math.pi)))
