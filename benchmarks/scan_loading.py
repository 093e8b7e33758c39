"""Time a large scan: loading, opening a world, computing a mesh and drawing, first and cached.

The scan is the house of two storeys of the tests, cut into a million triangles, with textures of
4096². It is written to a temporary folder, in the layout of HM3D. Each time is that of a process of
its own. Drawing is compared with small_house, image by image in turns.

    python benchmarks/scan_loading.py
    python benchmarks/scan_loading.py --basis      # textures in Basis Universal, extra hm3d
"""

import multiprocessing
import resource
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import cv2
import numpy as np
import tyro

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from render import CAMERA, TEST_DATA, standing_views

from gltf_writer import GltfWriter
from hypernav.lab.datasets.benchmarks import BENCHMARKS
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer
from hypernav.simulator.worlds.navmesh.navmesh import Navmesh
from hypernav.simulator.worlds.navmesh.navmesh_reader import navmesh_of
from hypernav.simulator.worlds.navmesh.robot_navmesh import computed_for
from hypernav.simulator.worlds.scans.scan_loading import ScanFiles, cached_scan, load_scan
from hypernav.simulator.worlds.scenes.loading import read_scene
from hypernav.simulator.worlds.simulation import SimulatedWorld
from scan_writers.basis_bytes import ktx2
from scan_writers.buildings import two_storeys
from scan_writers.scans import color_of, mesh_of, semantic_lines

TEXTURES, SIDE = 8, 4096
VIEWS, TURNS = 20, 5
HOUSE = two_storeys()
_Result = TypeVar("_Result")


@dataclass(frozen=True)
class Options:
    """The scan."""

    triangles: int = 1_000_000
    """Number of triangles, about."""
    basis: bool = False
    """Textures in Basis Universal instead of JPEG."""


def main(options: Options) -> None:
    """Write a scan, open it twice, and draw it."""
    with tempfile.TemporaryDirectory() as folder:
        path = write(options, Path(folder) / "00802-wcojb4TFT35")
        # Kernels are loaded before, and compiled if need be.
        for name in ("kernels", "first", "from the cache"):
            print(f"{name}:")
            in_a_process(open_world, path, Path(folder) / f"cache{name == 'kernels'}")
        print("drawing:")
        in_a_process(draw, path, Path(folder) / "cacheFalse")


def in_a_process(work: Callable[[Path, Path], object], path: Path, cache: Path) -> None:
    """Do some work in a process of its own."""
    process = multiprocessing.get_context("spawn").Process(target=work, args=(path, cache))
    process.start()
    process.join()


def open_world(path: Path, cache: Path) -> SimulatedWorld:
    """Open the scan and a world over it."""
    files = ScanFiles.of(path)
    assert files is not None
    scene = timed("  scene", lambda: cached_scan(files, load_scan, folder=cache))
    robot = BENCHMARKS["hm3d"].embodiment
    world = timed("  world", lambda: SimulatedWorld(scene, embodiment=robot))
    body = BENCHMARKS["ovon"].embodiment.body
    content = timed("  navigation mesh", lambda: computed_for(scene, body))
    navmesh = Navmesh(navmesh_of(content))
    print(f"  {len(navmesh.islands)} polygons, {navmesh.area_m2:.0f} m²")
    print(f"  {len(scene.faces):,} triangles, {len(scene.instances)} instances")
    tell_memory()
    return world


def draw(path: Path, cache: Path) -> None:
    """Draw views of the scan and of small_house in turns."""
    scan = open_world(path, cache).scene
    tell_memory()
    small_house = read_scene(TEST_DATA / "scenes" / "small_house" / "scene.glb")
    drawn = [(CpuRenderer(scene), standing_views(scene, VIEWS)) for scene in (scan, small_house)]
    seconds: list[list[float]] = [[], []]
    for turn in range(TURNS + 1):
        for (renderer, views), own in zip(drawn, seconds, strict=True):
            for view in views:
                begin = time.perf_counter()
                renderer.render(CAMERA, view)
                if turn > 0:
                    own.append(time.perf_counter() - begin)
    scan_ms, small_house_ms = (1e3 * float(np.median(own)) for own in seconds)
    ratio = scan_ms / small_house_ms
    print(f"  {scan_ms:.1f} ms an image, small_house {small_house_ms:.1f} ms: {ratio:.2f} times")
    tell_memory()


def tell_memory() -> None:
    """Print the most memory that this process has had."""
    print(f"  {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6:.2f} GB at most")


def timed(name: str, work: Callable[[], _Result]) -> _Result:
    """The result of some work, whose time is printed."""
    wall_s, processor_s = time.perf_counter(), time.process_time()
    result = work()
    wall_s, processor_s = time.perf_counter() - wall_s, time.process_time() - processor_s
    print(f"{name}: {wall_s:.2f} s, {processor_s:.2f} s of processor time")
    return result


def write(options: Options, folder: Path) -> Path:
    """Write the scan; returns the path of its mesh."""
    folder.mkdir(parents=True)
    positions, uv, triangles, owner = dense(options.triangles)
    visual, rng = GltfWriter(), np.random.default_rng(0)
    for part in np.array_split(triangles, TEXTURES):
        used, corners = np.unique(part, return_inverse=True)
        codes = rng.integers(60, 220, (SIDE // 8, SIDE // 8, 3), dtype=np.uint8)
        image = cv2.resize(codes, (SIDE, SIDE), interpolation=cv2.INTER_CUBIC)
        material = (
            in_basis(visual, image) if options.basis else visual.textured(image, suffix=".jpg")
        )
        attributes = {
            "POSITION": visual.array(positions[used]),
            "TEXCOORD_0": visual.array(uv[used]),
        }
        indices = visual.array(corners.astype(np.uint32).ravel())
        visual.node(
            mesh=visual.mesh({"attributes": attributes, "indices": indices, "material": material})
        )
    semantic = GltfWriter()
    colors = np.array([(*color_of(k), 255) for k in range(len(HOUSE.things))], np.uint8)[owner]
    attributes = {
        "POSITION": semantic.array(positions),
        "COLOR_0": semantic.array(colors, normalized=True),
    }
    semantic.node(
        mesh=semantic.mesh({"attributes": attributes, "indices": semantic.array(triangles.ravel())})
    )
    stem = folder.name.partition("-")[2]
    semantic.write(folder / f"{stem}.semantic.glb")
    (folder / f"{stem}.semantic.txt").write_text("\n".join(semantic_lines(HOUSE)))
    return visual.write(folder / f"{stem}.glb")


def dense(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Positions, texture coordinates and things of vertices, and triangles over them."""
    corners, _, _ = mesh_of(HOUSE.things)
    quads = corners.reshape(-1, 4, 3)
    sides = np.linalg.norm(quads[:, [1, 3]] - quads[:, :1], axis=2)
    spacing_m = float(np.sqrt(2.0 * sides.prod(axis=1).sum() / count))
    positions, uv, triangles, owner, first = [], [], [], [], 0
    for number, (quad, (width, height)) in enumerate(zip(quads, sides, strict=True)):
        columns, rows = (max(1, round(float(side) / spacing_m)) for side in (width, height))
        u, v = np.meshgrid(np.linspace(0, 1, columns + 1), np.linspace(0, 1, rows + 1))
        along, up = u.ravel()[:, None], v.ravel()[:, None]
        positions.append(quad[0] + along * (quad[1] - quad[0]) + up * (quad[3] - quad[0]))
        uv.append(np.hstack([along, up]))
        corner = first + (np.arange(columns) + (columns + 1) * np.arange(rows)[:, None]).ravel()
        above = corner + columns + 1
        triangles.append(np.stack([corner, corner + 1, above + 1], axis=1))
        triangles.append(np.stack([corner, above + 1, above], axis=1))
        owner.append(np.full(len(along), number // 6))
        first += len(along)
    return (
        np.concatenate(positions).astype(np.float32),
        np.concatenate(uv).astype(np.float32),
        np.concatenate(triangles).astype(np.uint32),
        np.concatenate(owner),
    )


def in_basis(writer: GltfWriter, image: np.ndarray) -> int:
    """A material with a texture in Basis Universal, of blocks of one colour each."""
    writer.document["extensionsRequired"] = ["KHR_texture_basisu"]
    content = writer.view(ktx2(image[::4, ::4].astype(int)))
    file: dict[str, Any] = {"bufferView": content, "mimeType": "image/ktx2"}
    source = {"source": writer.add("images", file)}
    texture = writer.add("textures", {"extensions": {"KHR_texture_basisu": source}})
    info = {"baseColorTexture": {"index": texture}}
    return writer.add("materials", {"pbrMetallicRoughness": info})


if __name__ == "__main__":
    main(tyro.cli(Options))
