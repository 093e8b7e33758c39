"""Time the walkable surface, geodesics and view points of a scene.

    python benchmarks/walkable.py --scene scene.glb

The scene is also subdivided into about a million triangles; a synthetic house of 20 × 20 m is
measured beside it.
"""

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import tyro

from hypernav.core.goal import Goal
from hypernav.simulator.worlds.drawing.rays import RayCaster
from hypernav.simulator.worlds.scenes.loading import read_scene
from hypernav.simulator.worlds.scenes.scene import Scene
from hypernav.simulator.worlds.surface.goal_regions import GoalRegions
from hypernav.simulator.worlds.surface.walkable import WalkableGrid


@dataclass(frozen=True)
class Arguments:
    """The options of the benchmark.

    Attributes:
        scene: File of the scene.
        repeats: Number of runs of each measurement; the median is printed.
        triangles: Number of triangles of the subdivided scene.
    """

    scene: Path
    repeats: int = 7
    triangles: int = 1_000_000


def main(arguments: Arguments) -> None:
    scene = read_scene(arguments.scene)
    measure_scene(scene, arguments.repeats)
    large = refined(scene, arguments.triangles)
    WalkableGrid.from_scene(large)
    show(
        f"walkable surface, {len(large.faces)} triangles",
        lambda: WalkableGrid.from_scene(large),
        min(arguments.repeats, 3),
    )
    measure_geodesics("20 × 20 m with furniture", furnished_square(), arguments.repeats)


def measure_scene(scene: Scene, repeats: int) -> None:
    print(f"{scene.name}: {len(scene.faces)} triangles")
    walkable = WalkableGrid.from_scene(scene)
    show("walkable surface", lambda: WalkableGrid.from_scene(scene), repeats)
    rays = RayCaster(scene)
    regions = GoalRegions(scene, walkable, rays)
    categories = regions.categories()
    labelled = [instance for instance in scene.instances if instance.label is not None]
    show(
        f"view points of all {len(labelled)} objects",
        lambda: GoalRegions(scene, walkable, rays).categories(),
        repeats,
    )
    region = regions.of(Goal(categories[0]))
    points = len(region.view_points)
    show(
        f"goal region '{categories[0]}', {points} points", lambda: regions.of(region.goal), repeats
    )
    measure_geodesics(scene.name, walkable, repeats)


def measure_geodesics(name: str, walkable: WalkableGrid, repeats: int) -> None:
    print(f"{name}: {walkable.standable.shape} cells, {walkable.area_m2():.0f} m² to stand on")
    rng = np.random.default_rng(0)
    points = [walkable.random_point(rng) for _ in range(200)]
    one, many = np.array(points[:1]), np.array(points)
    field = walkable.distance_field(one)
    field.distance(*points[0])
    show("distance field, 1 target", lambda: walkable.distance_field(one), repeats)
    show("distance field, 200 targets", lambda: walkable.distance_field(many), repeats)
    show("distance field, a query", lambda: [field.distance(*p) for p in points], repeats, 200)
    walkable.distance(points[0], points[1])
    pairs = list(zip(points[:20], points[20:40], strict=True))
    show("distance of two points", lambda: [walkable.distance(*p) for p in pairs], repeats, 20)
    steps = [(x, y, 0.4, 0.3) for x, y in points]
    show("step", lambda: [walkable.step(*s) for s in steps], repeats, 200)


def show(what: str, run: Callable[[], Any], repeats: int, parts: int = 1) -> None:
    seconds = []
    for _ in range(repeats):
        start = time.perf_counter()
        run()
        seconds.append(time.perf_counter() - start)
    print(f"  {what:45} {statistics.median(seconds) / parts * 1000.0:10.3f} ms")


def refined(scene: Scene, triangles: int) -> Scene:
    """The same surface in at least the given number of triangles: each is cut into four."""
    vertices, faces, owner = scene.vertices, scene.faces, scene.face_instance
    while len(faces) < triangles:
        a, b, c = (vertices[faces[:, k]] for k in range(3))
        corners = np.stack([a, b, c, (a + b) / 2, (b + c) / 2, (c + a) / 2], axis=1)
        pattern = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]])
        first = 6 * np.arange(len(faces))[:, None, None]
        vertices = corners.reshape(-1, 3).astype(np.float32)
        faces = (first + pattern).reshape(-1, 3).astype(np.int32)
        owner = np.repeat(owner, 4)
    n = len(faces)
    return replace(
        scene,
        vertices=vertices,
        faces=faces,
        uv=np.zeros((n, 3, 2), np.float32),
        colors=np.full((n, 3, 3), 255, np.uint8),
        normals=None,
        face_material=np.zeros(n, np.int32),
        face_instance=owner,
    )


def furnished_square() -> WalkableGrid:
    """A house of 20 × 20 m: walls with doors every 5 m and round furniture."""
    free = np.ones((400, 400), dtype=bool)
    free[[0, -1]] = free[:, [0, -1]] = False
    for wall in (100, 200, 300):
        free[wall - 6 : wall + 6] = free[:, wall - 6 : wall + 6] = False
        for door in (50, 150, 250, 350):
            free[wall - 6 : wall + 6, door - 9 : door + 9] = True
            free[door - 9 : door + 9, wall - 6 : wall + 6] = True
    rows, columns = np.mgrid[:400, :400]
    for row, column in np.random.default_rng(1).integers(0, 400, (60, 2)):
        free &= (rows - row) ** 2 + (columns - column) ** 2 > 64
    return WalkableGrid.from_mask(free)


if __name__ == "__main__":
    main(tyro.cli(Arguments))
