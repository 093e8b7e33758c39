"""Time what a navigation mesh is asked for while a robot walks on it.

    python benchmarks/navmesh.py [--file scene.navmesh]

Without a file, a mesh of the size of a large HM3D building's is written from a generated office.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import tyro

from hypernav.core.embodiment import BodyConfig
from hypernav.simulator.houses.building import Building
from hypernav.simulator.houses.generator import generate
from hypernav.simulator.worlds.navmesh.grid_mesh import mesh_from_grid
from hypernav.simulator.worlds.navmesh.navmesh import GoalPaths, Navmesh
from hypernav.simulator.worlds.navmesh.navmesh_reader import navmesh_of
from hypernav.simulator.worlds.navmesh.navmesh_writer import navmesh_bytes
from hypernav.simulator.worlds.surface.walkable import WalkableGrid

_OFFICE = Building("offices", 9)
_GOALS = 200


@dataclass(frozen=True)
class Arguments:
    """The options of the benchmark.

    Attributes:
        file: Navigation mesh of habitat-sim; by default one of a generated office.
        queries: Number of positions that are asked about.
        repeats: How often each is asked about; the fastest counts, against the noise of a machine
            that does other things, too.
    """

    file: Path | None = None
    queries: int = 500
    repeats: int = 5


def main(arguments: Arguments) -> None:
    content = _office() if arguments.file is None else arguments.file.read_bytes()
    navmesh = Navmesh(navmesh_of(content))
    rng = np.random.default_rng(0)
    points = [navmesh.random_point(rng) for _ in range(arguments.queries)]
    ends = [navmesh.random_point(rng) for _ in points]
    lengths = np.array(
        [navmesh.shortest_path(a, b).length_m for a, b in zip(points, ends, strict=True)]
    )
    found = lengths[np.isfinite(lengths)]
    print(
        f"{len(navmesh.mesh.corner_count)} polygons, {navmesh.area_m2:.0f} m², "
        f"{len(navmesh.areas_m2)} islands; paths of {np.mean(found):.1f} m, {len(found)} of "
        f"{len(lengths)} found"
    )
    repeats = arguments.repeats
    _show("read a file", lambda: Navmesh(navmesh_of(content)), [()] * 3, repeats)
    _show("nearest position", navmesh.nearest, [(p,) for p in points], repeats)
    steps = [(p, (p[0] + 0.15, p[1], p[2] + 0.2)) for p in points]
    _show("step", lambda a, b: navmesh.try_step(a, b, sliding=False), steps, repeats)
    _show("step with sliding", lambda a, b: navmesh.try_step(a, b, sliding=True), steps, repeats)
    _show("geodesic", navmesh.shortest_path, list(zip(points, ends, strict=True)), repeats)
    goals = np.array(ends[:_GOALS])
    paths = GoalPaths(navmesh, goals)
    paths.nearest(points[0])
    _show(f"nearest of {_GOALS} goals", paths.nearest, [(p,) for p in points], repeats)


def _office() -> bytes:
    grid = WalkableGrid.from_scene(generate(_OFFICE))
    return navmesh_bytes(mesh_from_grid(grid), BodyConfig())


def _show(
    what: str, ask: Callable[..., Any], questions: list[tuple[Any, ...]], repeats: int
) -> None:
    fastest = np.full(len(questions), np.inf)
    for _ in range(repeats):
        for number, question in enumerate(questions):
            start = time.perf_counter()
            ask(*question)
            fastest[number] = min(fastest[number], time.perf_counter() - start)
    median, worst = np.quantile(fastest, [0.5, 0.95]) * 1000.0
    print(f"  {what:30} {median:8.3f} ms   95 %: {worst:8.3f} ms")


if __name__ == "__main__":
    main(tyro.cli(Arguments))
