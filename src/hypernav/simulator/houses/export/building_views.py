"""Images of a building: from above, and from where a robot stands in it."""

import math
from collections.abc import Sequence
from contextlib import closing

import numpy as np
from jaxtyping import UInt8

from hypernav.core.embodiment import CameraConfig
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.simulator.houses.plan.floor_plan import FloorPlan, Rect
from hypernav.simulator.houses.random_stream import RandomStream
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer
from hypernav.simulator.worlds.scenes.scene import Scene
from hypernav.simulator.worlds.surface.walkable import WalkableGrid

_POSES_PER_ROOM = 16
_UNINTERESTING = ("window", "door", "ceiling lamp", "picture", "doormat")
_MIN_IMAGE_SHARE = 0.003
_NEAR_M = 1.0

Image = UInt8[np.ndarray, "height width 3"]


def storey_alone(scene: Scene, plan: FloorPlan) -> Scene:
    """One storey of a building, with the stairs that lead up from it."""
    top = plan.floor_z + plan.height - 0.05
    shown = np.array([plan.floor_z - 0.3 < i.box_min[2] < top for i in scene.instances])
    return scene.of_faces(shown[scene.face_instance])


def view_from_above(scene: Scene) -> Image:
    """Image of a building without its ceilings, straight from above."""
    hidden = np.array([i.name.startswith(("ceiling", "chandelier")) for i in scene.instances])
    open_scene = scene.of_faces(~hidden[scene.face_instance])
    vertices = scene.vertices.astype(np.float64)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    size = high - low
    width = 1280
    height = max(int(width * size[1] / size[0]), width // 4)
    focal = 2.5 * width
    above = 1.04 * max(size[0] * focal / width, size[1] * focal / height) + high[2]
    camera = PinholeCamera(width, height, focal, focal, width / 2, height / 2)
    looking_down = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])
    middle = (low + high) / 2.0
    pose = Transform(looking_down, np.array([middle[0], middle[1], above]))
    with closing(CpuRenderer(open_scene)) as renderer:
        return renderer.render(camera, pose).rgb


def views_from_above(scene: Scene, storeys: Sequence[FloorPlan]) -> list[Image]:
    """Image of every storey without its ceilings, the lowest first."""
    if len(storeys) == 1:
        return [view_from_above(scene)]
    return [view_from_above(storey_alone(scene, plan)) for plan in storeys]


def interior_views(
    scene: Scene,
    plan: FloorPlan,
    number: int,
    count: int,
    *,
    grid: WalkableGrid,
    renderer: CpuRenderer,
) -> list[Image]:
    """Camera images from different rooms, from the poses that show most objects."""
    config, rng = CameraConfig(), RandomStream(number, "views")
    best: list[tuple[float, Pose2]] = []
    renderer.colours = False
    for room in plan.rooms:
        positions = _positions_in(room.inner, grid)
        tries = []
        for _ in range(min(_POSES_PER_ROOM, len(positions))):
            pose = Pose2(
                *positions[rng.integer(0, len(positions) - 1)], rng.uniform(-math.pi, math.pi)
            )
            tries.append((_interest(scene, renderer, camera_pose(grid, config, pose)), pose))
        best += [max(tries, key=lambda t: t[0])] if tries else []
    renderer.colours = True
    chosen = sorted(best, key=lambda t: -t[0])[:count]
    return [
        renderer.render(config.intrinsics, camera_pose(grid, config, pose)).rgb
        for _, pose in chosen
    ]


def _positions_in(rect: Rect, grid: WalkableGrid) -> list[tuple[float, float]]:
    centres = grid.centres()
    low, high = np.array((rect.x0, rect.y0)), np.array((rect.x1, rect.y1))
    inside = ((centres > low) & (centres < high)).all(axis=1)
    return [(float(x), float(y)) for x, y in centres[inside]]


def camera_pose(grid: WalkableGrid, config: CameraConfig, pose: Pose2) -> Transform:
    """Pose of the camera's optical frame in the scene of a robot that stands on its floor."""
    return pose.to_transform(grid.height_at(*pose.xy)) @ config.camera_to_base


def _interest(scene: Scene, renderer: CpuRenderer, pose: Transform) -> float:
    """Score of a view: many objects that are not too small, and nothing too near."""
    seen = renderer.render(CameraConfig(width=160, height=120).intrinsics, pose)
    pixels = np.bincount(seen.instance_ids[seen.instance_ids >= 0], minlength=len(scene.instances))
    share = pixels / seen.instance_ids.size
    shown = [
        float(share[i.id])
        for i in scene.instances
        if i.label is not None
        and i.label.category not in _UNINTERESTING
        and share[i.id] > _MIN_IMAGE_SHARE
    ]
    near = float((seen.depth < _NEAR_M).mean())
    return len(shown) + 12.0 * min(sum(shown), 0.5) - 15.0 * near
