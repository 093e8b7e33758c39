"""What is true of a scene for a robot: where it can stand, and when a goal is reached."""

from collections.abc import Collection

import numpy as np
from jaxtyping import Float64

from hypernav.core.embodiment import Embodiment
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.world import Instance
from hypernav.simulator.worlds.config import SimulationConfig
from hypernav.simulator.worlds.drawing.rays import RayCaster
from hypernav.simulator.worlds.navmesh.navmesh_surface import NavmeshSurface
from hypernav.simulator.worlds.navmesh.robot_navmesh import robot_navmesh, storeys_on_mesh
from hypernav.simulator.worlds.scenes.scene import Scene
from hypernav.simulator.worlds.surface.goal_regions import GoalRegion, GoalRegions, random_start
from hypernav.simulator.worlds.surface.walkable import WalkableGrid
from hypernav.simulator.worlds.surface.walkable_surface import WalkableSurface


class SurveyedScene:
    """The part of a `SceneTruth` that follows from a scene's triangles and the robot's body.

    A world of one's own derives from it and adds the robot: `World` and the rest of `SceneTruth`.

    Attributes:
        scene: The scene that the robot is in.
        config: How the robot is simulated.
        embodiment: Body, camera and motion of the robot.
        walkable: The surface on which the robot can stand: a navigation mesh of all storeys, or the
            storey of the latest start.
        regions: The regions on this surface in which goals count as reached.
    """

    def __init__(
        self,
        scene: Scene,
        config: SimulationConfig | None = None,
        embodiment: Embodiment | None = None,
        *,
        rays: RayCaster | None = None,
        walkable: WalkableSurface | None = None,
    ) -> None:
        """Survey a scene for a robot.

        Args:
            scene: The scene.
            config: How the robot is simulated.
            embodiment: Body, camera and motion of the robot; by default the preset ``default``'s.
            rays: Ray caster of the scene; by default a new one.
            walkable: The surface on which the robot can stand; by default the navigation
                mesh that the configuration names, or computed from the scene where it has none.

        Raises:
            SceneError: The robot fits nowhere, or the navigation mesh can't be read or computed.
            MissingExtraError: Embree is not installed.
        """
        self.scene = scene
        self.config: SimulationConfig = config or SimulationConfig()
        self.embodiment: Embodiment = embodiment or Embodiment()
        self.walkable: WalkableSurface = walkable or self._surface_at(self.config.floor_z)
        self._rays: RayCaster = rays or RayCaster(scene)
        self.regions: GoalRegions = self._regions_on(self.walkable)
        self._storeys = [(self.walkable, self.regions)]

    @property
    def name(self) -> str:
        """Name of the scene."""
        return self.scene.name

    @property
    def instances(self) -> tuple[Instance, ...]:
        """All instances of the scene; an instance's id is its index."""
        return self.scene.instances

    def goals(self) -> tuple[str, ...]:
        """Categories of the objects that can be reached, sorted."""
        return self.regions.categories()

    def goal_truth(
        self, goal: Goal, view_points: Float64[np.ndarray, "n 3"] | None = None
    ) -> GoalRegion:
        """The region in which a goal counts as reached.

        Args:
            goal: The goal.
            view_points: View points of a data set, scene frame, metres; None takes the scene's own.
        """
        return self.regions.of(goal, view_points, self.instances)

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
        region = None if goal is None else self.regions.of(goal)
        return random_start(self.walkable, rng, region, nearest_m=nearest_m, farthest_m=farthest_m)

    def view_points_of(self, instance: Instance) -> Float64[np.ndarray, "n 3"]:
        """Points on the floor where the robot has reached one object; empty if there are none."""
        return self.regions.view_points(instance)

    def triangles_of(self, ids: Collection[int]) -> Float64[np.ndarray, "n 3 3"]:
        """The triangles of some instances, scene frame, metres."""
        return self.scene.triangles_of(ids)

    def enter_storey(self, z: float | None) -> None:
        """Take surface and regions of the storey at a height, computed once.

        Args:
            z: Height, metres; None means the configured or largest storey.

        Raises:
            SceneError: There is no storey at this height.
        """
        for storey in self._storeys:
            if z is None or storey[0].is_on_storey(np.array([z]))[0]:
                self.walkable, self.regions = storey
                return
        self.walkable = self._surface_at(z)
        self.regions = self._regions_on(self.walkable)
        self._storeys.append((self.walkable, self.regions))

    def _regions_on(self, walkable: WalkableSurface) -> GoalRegions:
        eye_height_m = self.config.judge_eye_m or self.embodiment.camera.height_m
        return GoalRegions(self.scene, walkable, self._rays, eye_height_m=eye_height_m)

    def _surface_at(self, z: float | None) -> WalkableSurface:
        """The robot's navigation mesh, or the walkable surface of the storey at a height."""
        body, choice = self.embodiment.body, self.config.navmesh
        storeys = storeys_on_mesh(self.scene, body, choice)
        navmesh = robot_navmesh(self.scene, body, choice, has_storeys=storeys is not None)
        if navmesh is not None:
            surface = NavmeshSurface(navmesh, storeys, self.config.stop_at)
            # What was found may be the top of a row of cupboards: a storey is come to.
            if storeys is None or self.scene.storeys or len(surface.storeys_z) > 1:
                return surface
        return WalkableGrid.from_scene(
            self.scene, self.embodiment.body, cell_m=self.config.cell_m, floor_z=z
        )
