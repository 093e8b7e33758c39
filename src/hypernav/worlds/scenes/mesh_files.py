"""Reads OBJ, PLY, STL and OFF files with trimesh."""

import codecs
import errno
import io
import struct
from pathlib import Path

import numpy as np
import trimesh
from jaxtyping import Float32, Int32, UInt8
from PIL.Image import Image as PilImage
from trimesh.resolvers import FilePathResolver
from trimesh.visual import ColorVisuals, TextureVisuals
from trimesh.visual.material import PBRMaterial

from hypernav.core.errors import SceneError
from hypernav.core.files.image_sizes import MOST_PIXELS, image_size
from hypernav.core.files.reading import path_below, read_file
from hypernav.worlds.scenes.scene import Material
from hypernav.worlds.scenes.scene_assembly import MeshPart

_Y_UP_TO_Z_UP = np.array(
    [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
)


_MOST_BYTES = 500_000_000
_BROKEN = (
    ArithmeticError,
    AssertionError,
    AttributeError,
    EOFError,
    LookupError,
    MemoryError,
    NameError,
    RecursionError,
    TypeError,
    ValueError,
    struct.error,
)
"""Errors that trimesh raises for broken files."""


class _FilesBeside(FilePathResolver):
    """Materials and textures that a mesh file names: regular files beside it, of limited size."""

    def get(self, name: str) -> bytes:
        content = read_file(path_below(Path(self.parent), name.strip()), most=_MOST_BYTES)
        size = image_size(content)
        if size is not None and size[0] * size[1] > MOST_PIXELS:
            raise OSError(
                errno.EFBIG,
                f"its texture {name:.80} has {size[0]} × {size[1]} pixels, at most "
                f"{MOST_PIXELS:,} are read",
            )
        return content.removeprefix(codecs.BOM_UTF8)


def read_mesh(path: Path, *, z_up: bool = False) -> tuple[list[MeshPart], list[Material]]:
    """All triangles of a file, in the scene frame, and its materials.

    None of these formats defines which axis is up: OBJ is read as y up, as written by modelling
    tools, the others as z up, as written by scanners. A PLY with colours is assumed to be a scan,
    whose colours already contain the light.

    Args:
        path: A file that trimesh can read.
        z_up: Whether it is z up, whatever its format.

    Raises:
        SceneError: The file cannot be read as a mesh.
        OSError: The file cannot be read, or is too large.
    """
    # trimesh would drop the first line of a text with a byte order mark, silently.
    content = io.BytesIO(read_file(path, most=_MOST_BYTES).removeprefix(codecs.BOM_UTF8))
    try:
        loaded = trimesh.load_scene(
            content,
            file_type=path.suffix[1:].lower(),
            resolver=_FilesBeside(str(path)),
            process=False,
            maintain_order=True,
        )
    except _BROKEN as error:
        raise SceneError(
            f"{path}: cannot be read as a mesh ({error}); export the file again"
        ) from error
    up = _Y_UP_TO_Z_UP if path.suffix.lower() == ".obj" and not z_up else np.eye(4)
    scanned = path.suffix.lower() == ".ply"
    parts: list[MeshPart] = []
    materials: list[Material] = []
    with np.errstate(all="ignore"):  # non-finite corners are left out later
        _collect(loaded, up, scanned, parts, materials)
    return parts, materials


def _collect(
    loaded: trimesh.Scene,
    up: np.ndarray,
    scanned: bool,
    parts: list[MeshPart],
    materials: list[Material],
) -> None:
    """Add the meshes of a file, placed by its scene graph, to the parts and materials."""
    for name in loaded.graph.nodes_geometry:
        to_scene, geometry = loaded.graph[name]
        mesh = loaded.geometry[geometry]
        if isinstance(mesh, trimesh.Trimesh) and len(mesh.faces):
            placed = mesh.copy()
            placed.apply_transform(up @ to_scene)
            parts.append(_part(str(name), placed, len(materials)))
            materials.append(_material(str(name), placed, scanned=scanned))


def _part(name: str, mesh: trimesh.Trimesh, material: int) -> MeshPart:
    faces: Int32[np.ndarray, "faces 3"] = np.ascontiguousarray(mesh.faces, dtype=np.int32)
    uv: Float32[np.ndarray, "faces 3 2"] | None = None
    colors: UInt8[np.ndarray, "faces 3 3"] | None = None
    visual = mesh.visual
    if isinstance(visual, TextureVisuals):
        if visual.uv is not None and len(visual.uv) == len(mesh.vertices):
            uv = np.asarray(visual.uv, dtype=np.float32)[faces]
    elif isinstance(visual, ColorVisuals) and visual.kind == "vertex":
        colors = np.asarray(visual.vertex_colors, dtype=np.uint8)[faces][..., :3].copy()
    elif isinstance(visual, ColorVisuals) and visual.kind == "face":
        each = np.asarray(visual.face_colors, dtype=np.uint8)[:, None, :3]
        colors = np.repeat(each, 3, axis=1)
    vertices = np.ascontiguousarray(mesh.vertices, dtype=np.float32)
    return MeshPart(name, name, vertices, faces, material, uv, colors)


def _material(name: str, mesh: trimesh.Trimesh, *, scanned: bool) -> Material:
    visual = mesh.visual
    if isinstance(visual, TextureVisuals):
        material = visual.material
        simple = material.to_simple() if isinstance(material, PBRMaterial) else material
        image = simple.image
        if isinstance(image, PilImage):
            return Material(name, (1.0, 1.0, 1.0), np.asarray(image.convert("RGB")).copy())
        red, green, blue = (float(value) / 255.0 for value in simple.diffuse[:3])
        return Material(name, (red, green, blue))
    colored = isinstance(visual, ColorVisuals) and visual.kind is not None
    plain = 1.0 if colored else 0.8
    return Material(name, (plain, plain, plain), unlit=colored and scanned)
