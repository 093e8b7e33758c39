"""The work of the warm-up process: calls every kernel that a first search needs.

It is run as a module, so that the waiting program imports none of this.
"""

import numpy as np

from hypernav.app.build.agents import build_agent
from hypernav.app.build.presets import preset
from hypernav.core.embodiment import Embodiment
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.simulator.worlds.box_room import DOOR, BoxRoom
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer
from hypernav.simulator.worlds.navmesh.grid_mesh import mesh_from_grid
from hypernav.simulator.worlds.navmesh.navmesh import Navmesh
from hypernav.simulator.worlds.navmesh.navmesh_reader import navmesh_of
from hypernav.simulator.worlds.navmesh.navmesh_surface import NavmeshSurface
from hypernav.simulator.worlds.navmesh.navmesh_writer import navmesh_bytes
from hypernav.simulator.worlds.scenes.mesh_parts import MeshPart, SceneObject, assemble
from hypernav.simulator.worlds.scenes.scene import Material
from hypernav.simulator.worlds.surface.walkable import WalkableGrid

_STEPS = 12


def warm_up() -> None:
    """Walk on a grid, draw, search, and walk on a mesh."""
    walk_on_grid()
    draw_tile()
    search_room()
    walk_on_mesh()


def walk_on_grid() -> None:
    """Step and find paths on the walkable grid of an empty room."""
    surface = WalkableGrid.from_mask(np.ones((40, 40), dtype=bool))
    here = surface.nearest_standable(1.0, 1.0)
    surface.move(here, 0.25, 0.0)
    surface.goal_field(np.array([here])).distance(0.5, 0.5)


def draw_tile() -> None:
    """Draw one triangle with a texture, in light."""
    corners = np.array([[2.0, -1.0, 0.0], [2.0, 1.0, 0.0], [2.0, 0.0, 2.0]], np.float32)
    part = MeshPart("tile", "tile", corners, np.array([[0, 1, 2]], np.int32), material=0)
    glaze = Material("glaze", (0.3, 0.6, 0.3), texture=np.full((2, 2, 3), 160, np.uint8))
    scene = assemble("tile", [part], [SceneObject("tile", frozenset({"tile"}), None)], [glaze])
    camera = Embodiment().camera
    pose = Pose2(0.0, 0.0, 0.0).to_transform() @ camera.camera_to_base
    CpuRenderer(scene).render(camera.intrinsics, pose)


def search_room() -> None:
    """Let the default agent search an empty room for its door, and for a missing object."""
    agent = build_agent(preset("default")).agent
    for goal in (DOOR, "nothing of the kind"):
        room = BoxRoom()
        agent.reset(Goal(goal))
        for _ in range(_STEPS):
            action = agent.act(room.observe())
            if action is None:
                break
            room.step(action)


def walk_on_mesh() -> None:
    """Step, slide and find paths on the navigation mesh of an empty room."""
    room = mesh_from_grid(WalkableGrid.from_mask(np.ones((40, 40), dtype=bool)))
    surface = NavmeshSurface(Navmesh(navmesh_of(navmesh_bytes(room, Embodiment().body))))
    x, y = surface.random_point(np.random.default_rng(0))
    here = surface.nearest_standable(x, y)
    surface.move(here, 0.25, 0.0)
    surface.move(here, 0.25, 0.0, sliding=True)
    surface.distance(here, surface.nearest_standable(1.0, 1.0))
    surface.goal_field(np.array([here])).distance(1.0, 1.0)


if __name__ == "__main__":
    warm_up()
