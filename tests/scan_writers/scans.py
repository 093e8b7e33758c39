"""Scans as HM3D stores them: z up, unlit, in chunks, with textures and semantic annotations."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from gltf_writer import GltfWriter
from scan_writers.buildings import House, Thing
from scan_writers.navmeshes import write_navmesh

_QUADS = np.array(
    [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
)
_UNIT = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
)
_BASIS_KINDS = {
    b"sB": ("GOOGLE_texture_basis", "image/x-basis"),
    b"\xabK": ("KHR_texture_basisu", "image/ktx2"),
}
_UV = np.array([[0.1, 0.9], [0.9, 0.9], [0.9, 0.1], [0.1, 0.1]], np.float32)


def color_of(number: int) -> tuple[int, int, int]:
    """The colour that marks the number-th thing, unlike any other's."""
    return (37 * number % 256, 101 * number % 256, (number + 90) % 256)


def mesh_of(things: Sequence[Thing]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions and texture coordinates of every corner, and triangles; 24 vertices a box."""
    boxes = [np.array(t.low) + _UNIT * (np.array(t.high) - np.array(t.low)) for t in things]
    positions = np.concatenate([box[_QUADS.ravel()] for box in boxes]).astype(np.float32)
    first = 4 * np.arange(6 * len(things))[:, None, None]
    triangles = (first + np.array([[0, 1, 2], [0, 2, 3]])).reshape(-1).astype(np.uint32)
    return positions, np.tile(_UV, (6 * len(things), 1)), triangles


def write_visual(house: House, path: Path, *, image: bytes | None = None) -> Path:
    """The textured scan, in two chunks of one unlit material each.

    Args:
        house: The building.
        path: Path of the ``.glb``.
        image: An image in Basis Universal that both chunks show; None writes PNGs.
    """
    writer = GltfWriter()
    for chunk in range(2):
        material = _texture(writer, chunk) if image is None else _basis_texture(writer, image)
        writer.document["materials"][material]["extensions"] = {"KHR_materials_unlit": {}}
        positions, uv, triangles = mesh_of(house.things[chunk::2])
        primitive = {
            "attributes": {"POSITION": writer.array(positions), "TEXCOORD_0": writer.array(uv)},
            "indices": writer.array(triangles),
            "material": material,
        }
        writer.node(name=f"chunk{chunk:03d}", mesh=writer.mesh(primitive))
    writer.document["extensionsUsed"] = ["KHR_materials_unlit"]
    path.parent.mkdir(parents=True, exist_ok=True)
    return writer.write(path)


def write_semantic_colors(
    house: House, path: Path, *, light_of: Callable[[int], tuple[float, ...]] | None = None
) -> Path:
    """The semantic mesh of HM3D v0.1: every vertex in the colour of its instance.

    Args:
        house: The building.
        path: Path of the file.
        light_of: Colour of the number-th thing as linear light; None writes codes of 8 bits.
    """
    writer = GltfWriter()
    positions, _, triangles = mesh_of(house.things)
    numbers = range(len(house.things))
    if light_of is None:
        codes = np.repeat([color_of(k) for k in numbers], 24, axis=0)
        colors = np.column_stack([codes, np.full(len(codes), 255)]).astype(np.uint8)
        accessor = writer.array(colors, normalized=True)
    else:
        light = np.repeat([light_of(k) for k in numbers], 24, axis=0)
        accessor = writer.array(light.astype(np.float32))
    primitive = {
        "attributes": {"POSITION": writer.array(positions), "COLOR_0": accessor},
        "indices": writer.array(triangles),
    }
    writer.node(mesh=writer.mesh(primitive))
    return writer.write(path)


def write_semantic_texture(house: House, path: Path) -> Path:
    """The semantic mesh of HM3D v0.2: a texture in the colours of the instances."""
    writer = GltfWriter()
    positions, _, triangles = mesh_of(house.things)
    count = len(house.things)
    atlas = np.repeat([[color_of(k) for k in range(count)]], 4, axis=0).astype(np.uint8)
    atlas = np.repeat(atlas, 4, axis=1)
    uv = np.tile(_UV, (6 * count, 1))
    uv[:, 0] = (np.repeat(np.arange(count), 24) + uv[:, 0]) / count
    primitive = {
        "attributes": {"POSITION": writer.array(positions), "TEXCOORD_0": writer.array(uv)},
        "indices": writer.array(triangles),
        "material": writer.textured(atlas),
    }
    writer.node(mesh=writer.mesh(primitive))
    return writer.write(path)


def semantic_lines(house: House) -> list[str]:
    """The annotation text, one instance a line; instance 1 is the first thing."""
    lines = ["HM3D Semantic Annotations"]
    for number, thing in enumerate(house.things):
        code = "".join(f"{channel:02X}" for channel in color_of(number))
        lines.append(f'{number + 1},{code},"{thing.category}",{thing.region}')
    return lines


def write_scan(house: House, folder: Path, *, image: bytes | None = None) -> Path:
    """A whole HM3D scene, such as ``hm3d/val/00802-wcojb4TFT35``.

    Returns:
        The path of its mesh.
    """
    stem = folder.name.partition("-")[2]
    suffix = ".basis.glb" if image is not None else ".glb"
    path = write_visual(house, folder / f"{stem}{suffix}", image=image)
    write_semantic_colors(house, folder / f"{stem}.semantic.glb")
    (folder / f"{stem}.semantic.txt").write_text("\n".join(semantic_lines(house)) + "\n")
    write_navmesh(house, folder / f"{stem}.basis.navmesh")
    return path


def _texture(writer: GltfWriter, chunk: int) -> int:
    noise = np.random.default_rng(chunk).integers(90, 200, (8, 8, 3), dtype=np.uint8)
    return writer.textured(cv2.resize(noise, (64, 64), interpolation=cv2.INTER_NEAREST))


def _basis_texture(writer: GltfWriter, content: bytes) -> int:
    extension, kind = _BASIS_KINDS[content[:2]]
    writer.document["extensionsRequired"] = [extension]
    file = {"bufferView": writer.view(content), "mimeType": kind}
    source: dict[str, Any] = {"source": writer.add("images", file)}
    info = {"index": writer.add("textures", {"extensions": {extension: source}})}
    return writer.add("materials", {"pbrMetallicRoughness": {"baseColorTexture": info}})
