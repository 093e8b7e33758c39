"""The warm-up of compiled kernels on the first run on a machine.

Numba compiles a kernel on its first call, once on a machine, and keeps it on disk. It holds
Python's global lock meanwhile, so only another process can compile at the same time. While this
process builds the world and its walkable surface, the warm-up process draws one triangle, lets
an agent search an empty room and walks on a navigation mesh. So it compiles the kernels of drawing,
mapping and planning, about half of all, in the order in which this process needs them, and then
those of scans, which are for the next run if this one has no scan.
"""

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from numba.extending import is_jitted

from hypernav.build.agents import build_agent
from hypernav.build.presets import preset
from hypernav.core.embodiment import Embodiment
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.evaluation.checks.box_room import DOOR, BoxRoom
from hypernav.mapping import integrate_kernels
from hypernav.worlds.drawing.renderer import CpuRenderer
from hypernav.worlds.navmesh.files.reader import navmesh_of
from hypernav.worlds.navmesh.files.writer import navmesh_bytes
from hypernav.worlds.navmesh.meshing.from_grid import mesh_from_grid
from hypernav.worlds.navmesh.navmesh import Navmesh
from hypernav.worlds.navmesh.surface import NavmeshSurface
from hypernav.worlds.scenes.scene import Material
from hypernav.worlds.scenes.scene_assembly import MeshPart, SceneObject, assemble
from hypernav.worlds.surface.walkable import WalkableGrid

FIRST_RUN = "first run: compiling for this machine, once, takes a quarter of a minute or more …"

_STEPS = 12


def is_compiled() -> bool:
    """Whether the kernels are compiled on this machine, judged by the first of them.

    What an older version of the source or another version of Python left behind doesn't count.
    """
    source = Path(integrate_kernels.__file__)
    kernel = integrate_kernels.integrate_frame
    if not is_jitted(kernel):
        return True  # NUMBA_DISABLE_JIT: nothing is compiled at all
    folder = kernel.stats.cache_path
    if folder is None:
        return False
    python = f"py{sys.version_info.major}{sys.version_info.minor}"
    indices = Path(folder).glob(f"{source.stem}.{kernel.__name__}-*.{python}.nbi")
    return any(index.stat().st_mtime >= source.stat().st_mtime for index in indices)


@contextmanager
def warm_up_in_background(say: Callable[[str], object]) -> Iterator[None]:
    """Compile kernels in another process while the block runs, unless they are compiled already.

    Nothing depends on that process: kernels that it has not compiled in time are compiled here.

    Args:
        say: Function that is called with the message that this run takes longer.
    """
    if is_compiled():
        yield
        return
    say(FIRST_RUN)
    if (os.cpu_count() or 1) < 2:
        yield
        return
    silent = subprocess.DEVNULL
    command = [sys.executable, "-m", "hypernav.evaluation.kernel_warmup"]
    with subprocess.Popen(command, stdin=silent, stdout=silent, stderr=silent) as process:
        try:
            yield
        finally:
            process.kill()


def warm_up() -> None:
    """Draw, then search, then walk on a mesh."""
    _draw_tile()
    _search_room()
    _walk_on_mesh()


def _draw_tile() -> None:
    """Draw one triangle with a texture, in light."""
    corners = np.array([[2.0, -1.0, 0.0], [2.0, 1.0, 0.0], [2.0, 0.0, 2.0]], np.float32)
    part = MeshPart("tile", "tile", corners, np.array([[0, 1, 2]], np.int32), material=0)
    glaze = Material("glaze", (0.3, 0.6, 0.3), texture=np.full((2, 2, 3), 160, np.uint8))
    scene = assemble("tile", [part], [SceneObject("tile", frozenset({"tile"}), None)], [glaze])
    camera = Embodiment().camera
    pose = Pose2(0.0, 0.0, 0.0).to_transform() @ camera.camera_to_base
    CpuRenderer(scene).render(camera.intrinsics, pose)


def _search_room() -> None:
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


def _walk_on_mesh() -> None:
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
