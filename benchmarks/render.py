"""Time the renderer on small_house, as it is and subdivided into a million triangles.

Run: python benchmarks/render.py [--scene FILE] [--out DIR] [--device cuda:0 --batches 8 32 128]
     [--peer]
A generated building, such as houses:1000, may stand in for the file, but habitat-sim, the peer,
opens files only: `hypernav houses export` writes them.

Poses are spread over the free floor of the scene, drawn with a fixed seed. Each is rendered once
before the measurement, so that compilation and the light baked on a first view don't count; "first
view" is timed with that light. Other programs on the machine affect the times: hence the CPU time
of all threads, and the ray casting alone, for comparison.
"""

import math
import os
import time
from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TypeVar

import cv2
import numpy as np
import tyro
from rich.console import Console
from rich.table import Table

from hypernav.app.build.data.scenes import load_scene
from hypernav.core.components.registry import require
from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.world import Renderer
from hypernav.lab.datasets.benchmarks import BENCHMARKS
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer, RenderConfig
from hypernav.simulator.worlds.drawing.warp_renderer import WarpRenderer
from hypernav.simulator.worlds.habitat import HabitatRenderer
from hypernav.simulator.worlds.scenes.scene import Scene

TEST_DATA = Path(os.environ.get("HYPERNAV_TEST_DATA", "../shared/data"))
ROBOT = BENCHMARKS["hm3d"].embodiment
CAMERA = ROBOT.camera.intrinsics
HEIGHT_M = 0.88
REPEATS = 5
T = TypeVar("T")


def main(
    scene: str = str(TEST_DATA / "scenes" / "small_house" / "scene.glb"),
    out: Path | None = None,
    poses: int = 40,
    triangles: int = 1_000_000,
    device: str | None = None,
    batches: tuple[int, ...] = (8, 32, 128),
    peer: bool = False,
) -> None:
    """Print the table.

    Args:
        scene: File of the scene, or the name of a generated building.
        out: Folder of the images; none are written without it.
        poses: Number of views to render.
        triangles: Number of triangles of the subdivided scene.
        device: Warp's name of the device on which the GPU renderer draws the same views, such as
            cuda:0 or cpu; without it, there are no rows of that renderer.
        batches: Numbers of views that the GPU renderer draws at a time in the rows "at a time",
            which give the time of one of them.
        peer: Whether habitat-sim draws the same views, each in turn with our renderer. It must be
            installed, and the scene be a file.
    """
    console = Console(width=110)
    start = time.perf_counter()
    loaded = load_scene(scene)
    console.print(f"{loaded.name}: loaded in {(time.perf_counter() - start) * 1e3:.0f} ms")
    views = standing_views(loaded, poses)
    title = "640×480, colour + depth + instances, ms"
    table = Table("scene", "what", "median", "p95", "CPU, all threads", title=title)
    if device is not None:
        console.print(f"Warp draws on {name_of(device)}")
    for size in (loaded, subdivided(loaded, triangles)):
        measure(table, size, views)
        if device is not None:
            measure_warp(table, size, views, device, batches)
            other = WarpRenderer(size, device=device)
            console.print(agreement(f"Warp on {device}", size, views, other))
    if peer:
        console.print(measure_peer(table, loaded, Path(scene), views))
    console.print(table)
    if out is not None:
        write_images(CpuRenderer(loaded), views, out)
        console.print(f"{len(views)} images in {out}")


def measure(table: Table, scene: Scene, views: list[Transform]) -> None:
    """Add the rows of one scene."""
    name = f"{len(scene.faces):,} triangles"
    start = time.perf_counter()
    renderer = CpuRenderer(scene)
    table.add_row(name, "build", f"{(time.perf_counter() - start) * 1e3:.0f}")
    plain = CpuRenderer(scene, RenderConfig(antialias=False))
    blind = CpuRenderer(scene, RenderConfig(colours=False, threads=1))
    looks = [timed(lambda v: renderer.render(CAMERA, v), view, 1) for view in views]
    add(table, name, "first view", looks[1:])
    for what, draw in (
        ("render", lambda v: renderer.render(CAMERA, v)),
        ("render, one ray a pixel", lambda v: plain.render(CAMERA, v)),
        ("depth and instances, one thread", lambda v: blind.render(CAMERA, v)),
        ("ray casting, one thread", caster(renderer, views)),
    ):
        for view in views:
            draw(view)
        add(table, name, what, [timed(draw, view, REPEATS) for view in views])


def measure_warp(
    table: Table, scene: Scene, views: list[Transform], device: str, batches: tuple[int, ...]
) -> None:
    """Add the rows of the GPU renderer for one scene."""
    name, on = f"{len(scene.faces):,} triangles", f"Warp on {device}"
    WarpRenderer(scene, device=device).render(CAMERA, views[0])  # compiles the kernels
    start = time.perf_counter()
    renderer = WarpRenderer(scene, device=device)
    table.add_row(name, f"{on}: build", f"{(time.perf_counter() - start) * 1e3:.0f}")
    looks = [timed(lambda v: renderer.render(CAMERA, v), view, 1) for view in views]
    add(table, name, f"{on}: first view", looks)
    plain = WarpRenderer(scene, RenderConfig(antialias=False), device)
    blind = WarpRenderer(scene, RenderConfig(colours=False), device)
    for what, drawn in (
        ("render", renderer),
        ("render, one ray a pixel", plain),
        ("depth and instances", blind),
    ):
        drawn.render_batch(CAMERA, views)
        alone = [timed(partial(drawn.render, CAMERA), view, REPEATS) for view in views]
        add(table, name, f"{on}: {what}", alone)
        for batch in batches:
            several = (views * batch)[:batch]
            wall, cpu = timed(partial(drawn.render_batch, CAMERA), several, REPEATS)
            a_view = [(wall / batch, cpu / batch)]
            add(table, name, f"{on}: {what}, {batch} at a time", a_view)


def measure_peer(table: Table, scene: Scene, file: Path, views: list[Transform]) -> str:
    """Add the rows of habitat-sim and of our renderer beside it; returns how alike they draw."""
    name = f"{len(scene.faces):,} triangles"
    with closing(HabitatRenderer(scene, file, ROBOT, "robot")) as habitat:
        beside = CpuRenderer(scene)
        draws = [partial(habitat.render, CAMERA), partial(beside.render, CAMERA)]
        for what, colours in (("render", True), ("depth and instances", False)):
            habitat.colours = beside.colours = colours
            for view in views:
                in_turn(draws, view, 1)
            spent = np.array([in_turn(draws, view, REPEATS) for view in views])
            add(table, name, f"habitat-sim: {what}", spent[:, 0])
            add(table, name, f"beside it: {what}", spent[:, 1])
            habitat.colours = True
        return agreement("habitat-sim", scene, views, habitat)


def name_of(device: str) -> str:
    """A device as Warp calls it and as its makers do."""
    warp = require("warp", extra="gpu")
    return f"{device}, {warp.get_device(device).name}"


def agreement(who: str, scene: Scene, views: list[Transform], other: Renderer) -> str:
    """How much another renderer shows as the CPU's does, over all pixels."""
    cpu = CpuRenderer(scene)
    gaps, ids, colours = [], [], []
    for view in views:
        expected, seen = cpu.render(CAMERA, view), other.render(CAMERA, view)
        gaps.append(np.abs(seen.depth - expected.depth))
        ids.append(seen.instance_ids == expected.instance_ids)
        colours.append(np.abs(seen.rgb.astype(int) - expected.rgb).mean())
    millimetre, centimetre = (np.mean(np.array(gaps) <= gap) for gap in (1e-3, 1e-2))
    return (
        f"{who}, {len(views)} views of {len(scene.faces):,} triangles: depth within 1 mm on "
        f"{millimetre:.4%} and 1 cm on {centimetre:.4%}, instances equal on {np.mean(ids):.4%} of "
        f"the pixels, colours {np.mean(colours):.2f} of 255 apart, at most {np.max(colours):.2f} "
        "in one view"
    )


def add(table: Table, scene: str, what: str, spent: np.ndarray | list[tuple[float, float]]) -> None:
    """Add a row of ``(wall, CPU)`` milliseconds."""
    (wall, cpu), late = np.median(spent, axis=0), np.percentile(spent, 95, axis=0)[0]
    table.add_row(scene, what, f"{wall:.1f}", f"{late:.1f}", f"{cpu:.1f}")


def timed(draw: Callable[[T], object], view: T, repeats: int) -> tuple[float, float]:
    """Best wall and best CPU time of a few runs, milliseconds."""
    return in_turn([draw], view, repeats)[0]


def in_turn(
    draws: Sequence[Callable[[T], object]], view: T, repeats: int
) -> list[tuple[float, float]]:
    """The same for each of several, of which each runs once before the first runs again."""
    spent = np.zeros((repeats, len(draws), 2))
    for times in spent:
        for draw, wall_and_cpu in zip(draws, times, strict=True):
            start, start_cpu = time.perf_counter(), time.process_time()
            draw(view)
            wall_and_cpu[:] = time.perf_counter() - start, time.process_time() - start_cpu
    return [(wall * 1e3, cpu * 1e3) for wall, cpu in spent.min(axis=0).tolist()]


def caster(renderer: CpuRenderer, views: list[Transform]) -> Callable[[Transform], object]:
    """A function that casts the rays of a view; the rays are prepared beforehand."""
    rays = CAMERA.rays().reshape(-1, 3)
    origins = {
        id(view): np.tile(view.translation.astype(np.float32), (len(rays), 1)) for view in views
    }
    directions = {id(view): (rays @ view.rotation.T).astype(np.float32) for view in views}
    return lambda view: renderer.rays.faces(origins[id(view)], directions[id(view)])


def standing_views(scene: Scene, count: int) -> list[Transform]:
    """Views from random positions with free space around the camera."""
    renderer = CpuRenderer(scene, RenderConfig(antialias=False))
    rng = np.random.default_rng(0)
    low, high = scene.vertices.min(axis=0), scene.vertices.max(axis=0)
    views: list[Transform] = []
    probe = PinholeCamera.from_hfov(16, 12, 100.0)
    while len(views) < count:
        x, y = rng.uniform(low[:2], high[:2])
        around = [
            renderer.render(probe, view_from(x, y, yaw)).depth
            for yaw in np.radians([0.0, 90.0, 180.0, 270.0])
        ]
        if np.min(around) > 0.3 and np.max(around) < 20.0:
            views.append(view_from(x, y, rng.uniform(-math.pi, math.pi)))
    return views


def view_from(x: float, y: float, yaw: float) -> Transform:
    return Pose2(float(x), float(y), float(yaw)).to_transform() @ optical_to_base(HEIGHT_M)


def subdivided(scene: Scene, triangles: int) -> Scene:
    """The same surfaces in more triangles: each is cut into four, the largest first."""
    while len(scene.faces) < triangles:
        a, b, c = (scene.vertices[scene.faces[:, corner]] for corner in range(3))
        areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
        cuts = min(len(areas), math.ceil((triangles - len(areas)) / 3))
        chosen = np.argsort(-areas, kind="stable")[:cuts]
        scene = cut_in_four(scene, chosen)
    return scene


def cut_in_four(scene: Scene, chosen: np.ndarray) -> Scene:
    kept = np.setdiff1d(np.arange(len(scene.faces)), chosen)
    corners = scene.vertices[scene.faces[chosen]]
    first = len(scene.vertices)
    middles = middle_values(corners).reshape(-1, 3)
    numbers = first + np.arange(len(middles), dtype=np.int32).reshape(-1, 3)
    faces = in_four(scene.faces[chosen], numbers)

    def cut(values: np.ndarray) -> np.ndarray:
        own = values[chosen]
        four = in_four(own, middle_values(own.astype(np.float32)).astype(values.dtype))
        return np.concatenate([values[kept], four])

    def repeated(values: np.ndarray) -> np.ndarray:
        return np.concatenate([values[kept], np.repeat(values[chosen], 4)])

    return replace(
        scene,
        vertices=np.concatenate([scene.vertices, middles.astype(np.float32)]),
        faces=np.concatenate([scene.faces[kept], faces.astype(np.int32)]),
        uv=cut(scene.uv),
        colors=cut(scene.colors),
        normals=None if scene.normals is None else cut(scene.normals),
        face_material=repeated(scene.face_material),
        face_instance=repeated(scene.face_instance),
    )


def middle_values(corners: np.ndarray) -> np.ndarray:
    """Halfway between corners 0 and 1, 1 and 2, 2 and 0."""
    return (corners + corners[:, [1, 2, 0]]) / 2


def in_four(corners: np.ndarray, middles: np.ndarray) -> np.ndarray:
    """Corners of the four parts of every triangle."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    ab, bc, ca = middles[:, 0], middles[:, 1], middles[:, 2]
    parts = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    stacked = np.stack([np.stack(part, axis=1) for part in parts], axis=1)
    return stacked.reshape(-1, *corners.shape[1:])


def write_images(renderer: CpuRenderer, views: list[Transform], out: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)
    for number, view in enumerate(views):
        rgb = renderer.render(CAMERA, view).rgb
        cv2.imwrite(str(out / f"view_{number:03d}.png"), cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR))


if __name__ == "__main__":
    tyro.cli(main)
