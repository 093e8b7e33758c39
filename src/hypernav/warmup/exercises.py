"""The work of the warm-up processes: together they call every kernel that a first search needs.

Each process runs this module with the name of its exercise, so that the waiting program imports
none of it; and each exercise imports what it needs itself, so that no process imports all.
"""

import gc
import sys

import numpy as np

from hypernav.core.embodiment import Embodiment
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.worlds.scenes.scene import Material, Scene
from hypernav.worlds.scenes.scene_assembly import MeshPart, SceneObject, assemble

_STEPS = 12
_TILE = [[2.0, -1.0, 0.0], [2.0, 1.0, 0.0], [2.0, 0.0, 2.0]]
_FLOOR = [[-4.0, -4.0, 0.0], [4.0, -4.0, 0.0], [0.0, 4.0, 0.0]]


def draw_tile() -> None:
    """Draw a tile, in light."""
    from hypernav.worlds.drawing.renderer import CpuRenderer

    camera = Embodiment().camera
    pose = Pose2(0.0, 0.0, 0.0).to_transform() @ camera.camera_to_base
    CpuRenderer(triangle(_TILE)).render(camera.intrinsics, pose)


def search_room() -> None:
    """Let the default agent search an empty room for its door, and for a missing object."""
    from hypernav.build.agents import build_agent
    from hypernav.build.presets import preset
    from hypernav.worlds.box_room import DOOR, BoxRoom

    agent = build_agent(preset("default")).agent
    for goal in (DOOR, "nothing of the kind"):
        room = BoxRoom()
        agent.reset(Goal(goal))
        for _ in range(_STEPS):
            action = agent.act(room.observe())
            if action is None:
                break
            room.step(action)


def walk_on_floor() -> None:
    """Find out where a robot can stand; step, slide and find paths there."""
    from hypernav.worlds.surface.walkable import WalkableGrid

    floor = WalkableGrid.from_scene(triangle(_FLOOR))
    here = floor.nearest_standable(0.0, 0.0)
    floor.move(here, 0.25, 0.0)
    floor.move(here, 0.25, 0.0, sliding=True)
    floor.goal_field(np.array([here])).distance(1.0, 1.0)


def walk_on_mesh() -> None:
    """Step, slide and find paths on the navigation mesh of an empty room."""
    from hypernav.worlds.navmesh.files.reader import navmesh_of
    from hypernav.worlds.navmesh.files.writer import navmesh_bytes
    from hypernav.worlds.navmesh.meshing.from_grid import mesh_from_grid
    from hypernav.worlds.navmesh.navmesh import Navmesh
    from hypernav.worlds.navmesh.surface import NavmeshSurface
    from hypernav.worlds.surface.walkable import WalkableGrid

    room = mesh_from_grid(WalkableGrid.from_mask(np.ones((40, 40), dtype=bool)))
    surface = NavmeshSurface(Navmesh(navmesh_of(navmesh_bytes(room, Embodiment().body))))
    x, y = surface.random_point(np.random.default_rng(0))
    here = surface.nearest_standable(x, y)
    surface.move(here, 0.25, 0.0)
    surface.move(here, 0.25, 0.0, sliding=True)
    surface.distance(here, surface.nearest_standable(1.0, 1.0))
    surface.goal_field(np.array([here])).distance(1.0, 1.0)


def triangle(corners: list[list[float]]) -> Scene:
    """A scene of one triangle with a texture."""
    vertices, indices = np.array(corners, np.float32), np.array([[0, 1, 2]], np.int32)
    part = MeshPart("tile", "tile", vertices, indices, material=0)
    texture = np.full((2, 2, 3), 160, np.uint8)
    texture.flags.writeable = False  # as those of a scene
    glaze = Material("glaze", (0.3, 0.6, 0.3), texture=texture)
    return assemble("tile", [part], [SceneObject("tile", frozenset({"tile"}), None)], [glaze])


EXERCISES = {
    "drawing": draw_tile,
    "searching": search_room,
    "walking": walk_on_floor,
    "scans": walk_on_mesh,
}

if __name__ == "__main__":
    gc.disable()  # compiling leaves few cycles behind, and is a tenth faster without looking
    EXERCISES[sys.argv[1]]()
