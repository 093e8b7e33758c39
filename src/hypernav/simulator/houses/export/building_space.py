"""A building in three dimensions for its page: what a camera sees of it, and its objects."""

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from jaxtyping import Float64

from hypernav.app.show.spatial.cloud import ColouredCloud
from hypernav.app.show.spatial.view import floor_plate, packed_cloud
from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.simulator.houses.plan.floor_plan import FloorPlan
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer
from hypernav.simulator.worlds.scenes.scene import Scene
from hypernav.simulator.worlds.surface.walkable import WalkableGrid

_APART_M = 1.5
"""Distance between two positions of the camera, metres."""
_CAMERA = PinholeCamera.from_hfov(240, 180, 95.0)
_ON_ROBOT = optical_to_base(1.5, pitch_deg=25.0)
"""High enough, and turned down enough, to see what stands on tables."""
_YAWS = tuple(quarter * math.pi / 2.0 for quarter in range(4))


def building_space(
    scene: Scene,
    storeys: Sequence[FloorPlan],
    renderer: CpuRenderer,
    progress: Callable[[int, int], None] | None = None,
) -> dict[str, Any]:
    """The content of the view of a building that can be turned.

    Args:
        scene: Scene of the building.
        storeys: Its storeys, the lowest first.
        renderer: Renderer of the scene.
        progress: Function that is called with the numbers of drawn images and of all.
    """
    cloud, floors, poses = ColouredCloud(), [], list[tuple[int, Pose2, float]]()
    for number, plan in enumerate(storeys, 1):
        grid = WalkableGrid.from_scene(scene, floor_z=plan.floor_z if scene.storeys else None)
        words = "Ground floor" if plan.floor_z == 0.0 else f"Floor at {plan.floor_z:+.1f} m"
        floors.append(floor_plate(number, words, plan.floor_z, _map_of(grid)))
        poses += [
            (number, Pose2(x, y, yaw), grid.height_at(x, y))
            for x, y in spread(grid.centres()).tolist()
            for yaw in _YAWS
        ]
    for done, (number, pose, z) in enumerate(poses, 1):
        camera_to_scene = pose.to_transform(z) @ _ON_ROBOT
        seen = renderer.render(_CAMERA, camera_to_scene)
        cloud.add(seen.rgb, seen.depth, _CAMERA, camera_to_scene, floor=number)
        if progress is not None:
            progress(done, len(poses))
    return {
        "floors": floors,
        "cloud": packed_cloud(cloud),
        "paths": [],
        "marks": [],
        "boxes": _boxes(scene, storeys),
        "isQuiet": True,
        "views": [],
    }


def spread(points: Float64[np.ndarray, "n 2"]) -> Float64[np.ndarray, "m 2"]:
    """Of points close together one in every square of a lattice: that next to its middle.

    Args:
        points: Points ``(x, y)``, metres.
    """
    squares = np.floor(points / _APART_M)
    off_m = np.linalg.norm(points - (squares + 0.5) * _APART_M, axis=1)
    nearest = np.argsort(off_m, kind="stable")
    _, first = np.unique(squares[nearest], axis=0, return_index=True)
    return points[nearest[first]]


def _map_of(grid: WalkableGrid) -> OccupancyGrid:
    cells = np.where(grid.components >= 0, Cell.FREE, Cell.UNKNOWN).astype(np.uint8)
    return OccupancyGrid(cells, grid.cell_m, grid.origin)


def _boxes(scene: Scene, storeys: Sequence[FloorPlan]) -> list[dict[str, Any]]:
    """The objects as boxes, each on the highest storey that does not begin above it."""
    return [
        {
            "floor": max(1, sum(plan.floor_z - 0.3 < one.box_min[2] for plan in storeys)),
            "low": [round(float(side), 3) for side in one.box_min],
            "high": [round(float(side), 3) for side in one.box_max],
            "color": "--bad",
            "words": one.label.category,
            "row": one.label.category,
        }
        for one in scene.instances
        if one.label is not None
    ]
