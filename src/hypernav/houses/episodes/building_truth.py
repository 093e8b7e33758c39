"""Ground truth of a house, from which its episodes are generated."""

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import cv2
import numpy as np
from jaxtyping import Float64

from hypernav.core.embodiment import BodyConfig, CameraConfig
from hypernav.core.goal import Goal
from hypernav.core.world import Instance
from hypernav.worlds.drawing.rays import RayCaster
from hypernav.worlds.scenes.scene import Scene
from hypernav.worlds.surface.goal_regions import GoalRegions
from hypernav.worlds.surface.walkable import WalkableGrid

EXTRA_CLEARANCE_M = 0.1
"""Additional clearance on both sides of a path from start to goal, metres: an episode that begins
inside a shower cabin would test steering, not searching."""

_FLOOR = "floor_"
_PATH_STEP_M = 0.1


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
