"""Goal regions: positions from which a goal counts as reached, and distances to them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from hypernav.core.goal import Goal
from hypernav.core.world import Instance
from hypernav.worlds.drawing.rays import RayCaster
from hypernav.worlds.scenes.scene import Scene
from hypernav.worlds.surface.view_points import EYE_HEIGHT_M, REACH_M, view_points
from hypernav.worlds.surface.walkable_surface import PathField, WalkableSurface


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
