"""Reads OBJ, PLY, STL and OFF files with trimesh.

The text of an OBJ file is first put into the form that trimesh reads: one object per name, counted
indices.
"""

import codecs
import errno
import io
import logging
import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from jaxtyping import Float32, Int32, UInt8
from PIL.Image import Image as PilImage
from trimesh.resolvers import FilePathResolver
from trimesh.visual import ColorVisuals, TextureVisuals
from trimesh.visual.material import PBRMaterial

from hypernav.core.errors import SceneError
from hypernav.core.naming.words import composed
from hypernav.io.reading import MOST_PIXELS, Allowance, image_size, path_below, read_file, text_of
from hypernav.simulator.worlds.config import Axis
from hypernav.simulator.worlds.scenes.mesh_parts import TO_Z_UP, MeshPart, triangles_of_polygons
from hypernav.simulator.worlds.scenes.scene import Material

_NAME_LINE = re.compile(rb"^[ \t]*(o|g|usemtl)(?:[ \t]+([^\r\n]*?))?[ \t]*\r?$", re.MULTILINE)
_RELATIVE = re.compile(rb"^[ \t]*f[ \t][^\r\n]*?[ \t/]-", re.MULTILINE)
_INDEX = re.compile(rb"-\d+")
_POLYGON = re.compile(rb"^[ \t]*f[ \t]+(\S+(?:[ \t]+\S+){3,})[ \t]*\r?$", re.MULTILINE)
_VERTEX = re.compile(rb"^[ \t]*v[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)", re.MULTILINE)
_MARK = re.compile(r"object (\d+) ")
_LOGGER = logging.getLogger(__name__)
_MOST_BYTES, _MOST_OBJECTS = 500_000_000, 20_000
_BYTES_PER_CORNER = 400
_OBJECT_NUMBERS = ("object_id", "objectId", "instance_id")
"""Properties of faces that say which object of a scan they belong to, as in Replica."""
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


@dataclass(frozen=True)
class ObjText:
    """An OBJ file whose objects are called by numbers.

    trimesh puts an object's name and its material's into one; a number can be found in it again.

    Attributes:
        content: The text for trimesh.
        names: Names of the objects, by number; empty for a file without any.
    """

    content: bytes
    names: tuple[str, ...] = ()

    @staticmethod
    def of(content: bytes) -> "ObjText":
        """The text of a file.

        Objects are what ``o`` names; if it names no more than one, what ``g`` names.

        Raises:
            ValueError: It has too many objects or materials.
            OSError: Its polygons would take too much memory.
        """
        if _RELATIVE.search(content):
            content = _with_absolute_indices(content)
        content = _with_triangles(content)
        named: dict[bytes, dict[bytes, int]] = {b"o": {}, b"g": {}, b"usemtl": {}}
        for line in _NAME_LINE.finditer(content):
            numbers = named[line[1]]
            if len(numbers) <= _MOST_OBJECTS:
                numbers.setdefault(line[2] or b"", len(numbers))
        letter = b"g" if len(named[b"o"]) <= 1 and named[b"g"] else b"o"
        numbers = named[letter]
        _check_count(max(len(numbers), len(named[b"usemtl"])))
        if not numbers:
            return ObjText(content)

        def numbered(line: re.Match[bytes]) -> bytes:
            if line[1] == b"usemtl":
                return line[0]
            return b"o object %d " % numbers[line[2] or b""] if line[1] == letter else b""

        names = (composed(name.decode("utf-8", errors="replace")) for name in numbers)
        return ObjText(_NAME_LINE.sub(numbered, content), tuple(names))

    def name_of(self, geometry: str) -> str:
        """The object that trimesh's name of a geometry means; itself for a file without names."""
        mark = _MARK.match(f"{geometry.replace('_', ' ')} ") if self.names else None
        return geometry if mark is None else self.names[int(mark[1])] or geometry


def _check_count(count: int) -> None:
    # Each costs trimesh the time of a thousand triangles, and a material that of all before it.
    if count > _MOST_OBJECTS:
        raise ValueError(
            f"it has more than {_MOST_OBJECTS:,} objects or materials, which are not read"
        )


def _with_absolute_indices(content: bytes) -> bytes:
    """The text with indices from the beginning, where faces count back from their own line."""
    counts = {b"v": 0, b"vt": 0, b"vn": 0}
    lines = content.split(b"\n")
    for k, line in enumerate(lines):
        word, _, rest = line.strip().partition(b" ")
        if word in counts:
            counts[word] += 1
        elif word == b"f" and b"-" in rest:
            lines[k] = b"f " + b" ".join(_absolute(corner, counts) for corner in rest.split())
    return b"\n".join(lines)


def _with_triangles(content: bytes) -> bytes:
    """The text with triangles in place of polygons, of which trimesh makes fans."""
    corner_count = sum(
        line[1].count(b" ") + line[1].count(b"\t") + 1 for line in _POLYGON.finditer(content)
    )
    Allowance().spend(_BYTES_PER_CORNER * corner_count, "its polygons")
    polygons = [line[1].split() for line in _POLYGON.finditer(content)]
    if not polygons:
        return content
    counts = np.array([len(corners) for corners in polygons], dtype=np.int64)
    corners = [corner for polygon in polygons for corner in polygon]
    try:
        vertices = np.array([line.groups() for line in _VERTEX.finditer(content)]).astype(float)
        used = np.array([corner.partition(b"/")[0] for corner in corners]).astype(np.int64)
        points = vertices[used - 1]
    except (ValueError, LookupError):
        return content  # trimesh says what is wrong with it
    triangles = triangles_of_polygons(counts, points)
    owner = np.repeat(np.arange(len(counts)), counts)[triangles[:, 0]]
    lines: list[list[bytes]] = [[] for _ in polygons]
    for k, numbers in zip(owner.tolist(), triangles.tolist(), strict=True):
        lines[k].append(b"f " + b" ".join(corners[number] for number in numbers))
    replacing = iter(lines)
    return _POLYGON.sub(lambda _: b"\n".join(next(replacing)), content)


def _absolute(corner: bytes, counts: dict[bytes, int]) -> bytes:
    indices = zip(corner.split(b"/"), counts.values(), strict=False)
    return b"/".join(
        b"%d" % (count + 1 + int(text)) if _INDEX.fullmatch(text) else text
        for text, count in indices
    )


class _FilesBeside(FilePathResolver):
    """Materials and textures that a mesh file names: regular files beside it, of limited size."""

    def get(self, name: str) -> bytes:
        try:
            content = read_file(path_below(Path(self.parent), name.strip()), most=_MOST_BYTES)
        except OSError as error:
            _LOGGER.warning(
                "%s: the file %.80s, which it names, cannot be read (%s); surfaces are plain",
                self.file_name,
                name,
                error.strerror or error,
            )
            raise
        size = image_size(content)
        if size is not None and size[0] * size[1] > MOST_PIXELS:
            raise OSError(
                errno.EFBIG,
                f"its texture {name:.80} has {size[0]} × {size[1]} pixels, at most "
                f"{MOST_PIXELS:,} are read",
            )
        return content.removeprefix(codecs.BOM_UTF8)


def read_mesh(path: Path, *, up: Axis) -> tuple[list[MeshPart], list[Material]]:
    """All triangles of a file, in the scene frame, and its materials.

    None of these formats defines which axis is up. A PLY with colours is assumed to be a scan,
    whose colours already contain the light.

    Args:
        path: A file that trimesh can read.
        up: The axis of the file that points up.

    Raises:
        SceneError: The file cannot be read as a mesh.
        OSError: The file cannot be read, or is too large.
    """
    suffix = path.suffix.lower()
    content = read_file(path, most=_MOST_BYTES)
    name_of = str
    options: dict[str, Any] = {"maintain_order": True}
    upright = np.eye(4)
    upright[:3, :3] = TO_Z_UP[up]
    parts: list[MeshPart] = []
    materials: list[Material] = []
    try:
        if suffix == ".obj":
            text = ObjText.of(_in_utf8(content))
            content, name_of = text.content, text.name_of
            # Order kept, every object would hold the vertices of all.
            options = {"split_objects": True} if text.names else options
        loaded = trimesh.load_scene(
            io.BytesIO(content),
            file_type=suffix[1:],
            resolver=_FilesBeside(str(path)),
            process=False,
            **options,
        )
        with np.errstate(all="ignore"):  # non-finite corners are left out later
            for name, mesh in _meshes(loaded):
                placed = mesh.copy()
                placed.apply_transform(upright @ loaded.graph[name][0])
                node, scanned = name_of(name), suffix == ".ply"
                part = _part(node, placed, len(materials))
                parts += _objects_of_faces(part, mesh) if scanned else [part]
                materials.append(_material(node, placed, scanned=scanned))
    except _BROKEN as error:
        raise SceneError(
            f"{path}: cannot be read as a mesh ({error}); export the file again"
        ) from error
    return parts, materials


def _in_utf8(content: bytes) -> bytes:
    """A text in UTF-8 without a byte order mark, whose first line trimesh would drop, silently.

    What is neither UTF-8 nor UTF-16 is of an older Windows program.
    """
    try:
        return text_of(content).encode()
    except UnicodeDecodeError:
        return content.decode("cp1252", errors="replace").encode()


def _meshes(loaded: trimesh.Scene) -> Iterator[tuple[str, trimesh.Trimesh]]:
    """The nodes of a file that show triangles."""
    for name in loaded.graph.nodes_geometry:
        mesh = loaded.geometry[loaded.graph[name][1]]
        if isinstance(mesh, trimesh.Trimesh) and len(mesh.faces):
            yield name, mesh


def _objects_of_faces(part: MeshPart, mesh: trimesh.Trimesh) -> list[MeshPart]:
    """A scan's part, divided into the objects that a property of its faces numbers."""
    faces = mesh.metadata.get("_ply_raw", {}).get("face", {})
    data = faces.get("data")
    names = data if isinstance(data, dict) else getattr(data, "dtype", np.dtype(int)).names or ()
    number = next((name for name in _OBJECT_NUMBERS if name in names), None)
    if number is None:
        return [part]
    numbers = np.asarray(data[number]).ravel()
    polygons, triangles = len(numbers), len(part.faces)
    if triangles % max(polygons, 1):
        return [part]
    # trimesh divides quads into their first triangles and, behind these, their second ones.
    numbers = np.tile(numbers, triangles // polygons)
    order = np.argsort(numbers, kind="stable")
    values, first = np.unique(numbers[order], return_index=True)
    _check_count(len(values))
    named = {f"object {k}": own for k, own in zip(values, np.split(order, first[1:]), strict=True)}
    return [
        replace(part.of_faces(own), node=name, descriptive_name=name) for name, own in named.items()
    ]


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
