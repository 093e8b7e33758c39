"""Ground truth of a building, from which its episodes are generated."""

import math
from bisect import bisect
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import cv2
import numpy as np
from jaxtyping import Float64

from hypernav.core.embodiment import STAIR_CLIMB_M, BodyConfig, CameraConfig
from hypernav.core.errors import SceneError
from hypernav.core.goal import Goal
from hypernav.core.world import Instance
from hypernav.simulator.worlds.drawing.rays import RayCaster
from hypernav.simulator.worlds.navmesh.navmesh_surface import NavmeshSurface
from hypernav.simulator.worlds.navmesh.robot_navmesh import robot_navmesh
from hypernav.simulator.worlds.scenes.scene import Scene
from hypernav.simulator.worlds.surface.goal_regions import GoalRegion, GoalRegions
from hypernav.simulator.worlds.surface.walkable import WalkableGrid

EXTRA_CLEARANCE_M = 0.1
"""Additional clearance on both sides of a path from start to goal, metres: an episode that begins
inside a shower cabin would test steering, not searching."""

CLIMBING_BODY = BodyConfig(max_step_m=STAIR_CLIMB_M)
"""The default robot with Habitat's step."""

_FLOOR = "floor_"
_PATH_STEP_M = 0.1
_ON_FLOOR_M = 0.1
_NEAR_FLOOR_M = 0.3


@dataclass(frozen=True, eq=False)
class BuildingTruth:
    """Scene with its goal regions.

    Attributes:
        scene: Scene of the building.
        regions: Regions where goals count as reached.
    """

    scene: Scene
    regions: GoalRegions

    def satisfying(self, text: str) -> tuple[Instance, ...]:
        """Instances that satisfy a goal text."""
        if text not in self._satisfying:
            goal = Goal(text)
            self._satisfying[text] = tuple(
                i for i in self.scene.instances if i.label is not None and i.label.satisfies(goal)
            )
        return self._satisfying[text]

    @cached_property
    def _satisfying(self) -> dict[str, tuple[Instance, ...]]:
        return {}

    def region(self, text: str) -> GoalRegion:
        """Region where a goal text counts as reached."""
        if text not in self._regions:
            self._regions[text] = self.regions.of(Goal(text))
        return self._regions[text]

    @cached_property
    def _regions(self) -> dict[str, GoalRegion]:
        return {}


@dataclass(frozen=True, eq=False)
class HouseGroundTruth(BuildingTruth):
    """Scene of one storey with its walkable surface, for the default robot and camera.

    Attributes:
        walkable: Surface where the robot can stand.
    """

    walkable: WalkableGrid

    @staticmethod
    def of(scene: Scene) -> "HouseGroundTruth":
        """Compute the ground truth of a scene.

        Raises:
            SceneError: The robot fits nowhere.
        """
        walkable = WalkableGrid.from_scene(scene, BodyConfig())
        camera_height_m = CameraConfig().height_m
        regions = GoalRegions(scene, walkable, RayCaster(scene), eye_height_m=camera_height_m)
        return HouseGroundTruth(scene, regions, walkable)

    @cached_property
    def wide_area(self) -> WalkableGrid:
        """Surface where a robot with `EXTRA_CLEARANCE_M` more radius could stand."""
        reach = round(EXTRA_CLEARANCE_M / self.walkable.cell_m)
        disk = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * reach + 1, 2 * reach + 1))
        mask = (self.walkable.components == 0).astype(np.uint8)
        # Cells outside the grid are no floor.
        mask = cv2.erode(mask, disk, borderType=cv2.BORDER_CONSTANT, borderValue=0)
        return WalkableGrid.from_mask(
            mask.astype(bool),
            cell_m=self.walkable.cell_m,
            origin=self.walkable.origin,
            floor_z=self.walkable.floor_z,
        )

    @cached_property
    def start_centres(self) -> Float64[np.ndarray, "n 2"]:
        """Centres of the cells that a start may lie in: the largest component of the wide area."""
        return self.wide_area.centres()

    @cached_property
    def places(self) -> Float64[np.ndarray, "n 3"]:
        """The same centres with the height of the floor there."""
        heights = [self.walkable.height_at(x, y) for x, y in self.start_centres.tolist()]
        return np.column_stack([self.start_centres, heights])

    def touches_wide_area(self, points: Float64[np.ndarray, "n 3"]) -> bool:
        """Whether one of the points lies in the component of the wide area that starts lie in."""
        return any(self.wide_area.component_of(x, y) == 0 for x, y, _ in points.tolist())

    @cached_property
    def _floors(self) -> tuple[Instance, ...]:
        return tuple(
            i for i in self.scene.instances if i.label is None and i.name.startswith(_FLOOR)
        )

    def rooms_on(self, path: list[tuple[float, float]]) -> int:
        """Number of rooms that a path touches; 0 if the scene doesn't name its floors.

        Args:
            path: Corners of the path, metres, scene frame.
        """
        names = set()
        for (x0, y0), (x1, y1) in pairwise(path):
            steps = max(1, math.ceil(math.hypot(x1 - x0, y1 - y0) / _PATH_STEP_M))
            for k in range(steps + 1):
                t = k / steps
                names.add(self._room_at(x0 + t * (x1 - x0), y0 + t * (y1 - y0)))
        return len(names - {None})

    def _room_at(self, x: float, y: float) -> str | None:
        """Name of the floor under a point; None between two rooms."""
        for floor in self._floors:
            (x0, y0, _), (x1, y1, _) = floor.box_min, floor.box_max
            if x0 <= x <= x1 and y0 <= y <= y1:
                return floor.name
        return None


@dataclass(frozen=True, eq=False)
class StoreyTruth(BuildingTruth):
    """Scene of several storeys with the surface of a robot that climbs stairs.

    Attributes:
        surface: Where the robot can stand.
        wide: Where a robot with more clearance could stand, see `EXTRA_CLEARANCE_M`.
        starts: Positions on the largest part of the wide surface, storey by storey.
    """

    surface: NavmeshSurface
    wide: NavmeshSurface
    starts: tuple[Float64[np.ndarray, "n 3"], ...]

    @staticmethod
    def of(scene: Scene) -> "StoreyTruth":
        """Compute the ground truth of a scene.

        Raises:
            SceneError: The robot fits nowhere.
        """
        surface = _surface(scene, CLIMBING_BODY)
        radius_m = CLIMBING_BODY.radius_m + EXTRA_CLEARANCE_M
        wide = _surface(scene, CLIMBING_BODY.model_copy(update={"radius_m": radius_m}))
        floor = wide.floor
        eye_height_m = CameraConfig().height_m
        return StoreyTruth(
            scene,
            GoalRegions(scene, surface, RayCaster(scene), eye_height_m=eye_height_m),
            surface,
            wide,
            tuple(floor[np.abs(floor[:, 2] - z) < _ON_FLOOR_M] for z in scene.storeys),
        )

    @property
    def places(self) -> Float64[np.ndarray, "n 3"]:
        """The starts of all storeys."""
        return np.concatenate(self.starts)

    def touches_wide_area(self, points: Float64[np.ndarray, "n 3"]) -> bool:
        """Whether one of the points lies on the part of the wide surface that starts lie on."""
        return any(self.wide.component_of(*point) == 0 for point in points.tolist())

    def storey_of(self, instances: Sequence[Instance]) -> int | None:
        """The storey that holds all of several things; None if they are on different ones."""
        heights = (i.box_min[2] + _NEAR_FLOOR_M for i in instances)
        found = {bisect(self.scene.storeys, z) - 1 for z in heights}
        return found.pop() if len(found) == 1 else None


def _surface(scene: Scene, body: BodyConfig) -> NavmeshSurface:
    navmesh = robot_navmesh(scene, body, "auto")
    if navmesh is None:
        raise SceneError(f"{scene.name}: expected a scene with several storeys")
    return NavmeshSurface(navmesh)


def truth_of(scene: Scene) -> HouseGroundTruth | StoreyTruth:
    """The ground truth of a building with one storey or several.

    Raises:
        SceneError: The robot fits nowhere.
    """
    return StoreyTruth.of(scene) if scene.storeys else HouseGroundTruth.of(scene)
