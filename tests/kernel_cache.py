"""Numba's kernels, compiled once for all processes of the tests before the first test.

Otherwise each process compiles what its first tests need. Two processes share the work, which
takes each of them half a minute where nothing is compiled.
"""

import subprocess
import sys
from pathlib import Path

import numpy as np

_SOURCE = Path(__file__).parents[1] / "src"
_PARTS = ("worlds", "searches")
_STEPS = 15


def compile_missing_kernels() -> None:
    """Fill the cache, if it lacks a kernel module. What cannot be compiled fails in its test."""
    if not any(map(_is_missing, sorted(_SOURCE.rglob("*_kernels.py")))):
        return
    processes = [subprocess.Popen([sys.executable, __file__, part]) for part in _PARTS]
    for process in processes:
        process.wait()


def _is_missing(source: Path) -> bool:
    """Whether nothing of a kernel module has been kept."""
    if "cache=True" not in source.read_text():
        return False
    python = f"py{sys.version_info.major}{sys.version_info.minor}"
    return not any((source.parent / "__pycache__").glob(f"{source.stem}.*.{python}.nbi"))


def _compile_worlds() -> None:
    """Draw, and walk on a mesh."""
    from hypernav.app.warmup.exercises import draw_tile, walk_on_mesh

    draw_tile()
    walk_on_mesh()


def _compile_searches() -> None:
    """Search with each method that has kernels of its own, with a robot that climbs, and walk.

    The mesh of a hill is computed here, so that both parts take as long.
    """
    from hypernav.app.build.agents import build_agent
    from hypernav.app.build.components.component_specs import ComponentSpecs
    from hypernav.app.warmup.exercises import search_room
    from hypernav.core.embodiment import BodyConfig
    from hypernav.core.goal import Goal
    from hypernav.simulator.worlds.box_room import BoxRoom
    from hypernav.simulator.worlds.navmesh.file_format import settings_for
    from hypernav.simulator.worlds.navmesh.recast_detour.recast_build import compute_navmesh
    from small_worlds import small_config, two_rooms

    search_room()
    climbing = small_config(embodiment={"body": {"max_step_m": 0.2}})
    for method in ("vlfm", "vlmnav", "hypernav"):
        agent = build_agent(climbing, ComponentSpecs(agent=method)).agent
        agent.reset(Goal("nothing of the kind"))
        room = BoxRoom()
        for _ in range(_STEPS):
            action = agent.act(room.observe())
            if action is None:
                break
            room.step(action)
    floor = two_rooms().walkable
    here = floor.nearest_standable(2.0, 1.0)
    floor.move(here, 0.25, 0.0)
    floor.move(here, 0.5, -9.0, sliding=True)
    floor.goal_field(np.array([here])).distance(7.0, 3.0)
    hill = [[0.0, 0.0, 0.0], [0.0, 0.0, 9.0], [9.0, 0.0, 9.0], [9.0, 0.0, 0.0], [4.5, 2.0, 4.5]]
    sides = [[k, (k + 1) % 4, 4] for k in range(4)]
    compute_navmesh(
        np.array(hill, np.float32), np.array(sides, np.int32), settings_for(BodyConfig())
    )


if __name__ == "__main__":
    {"worlds": _compile_worlds, "searches": _compile_searches}[sys.argv[1]]()
