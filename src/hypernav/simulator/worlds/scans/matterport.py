"""The annotations of a Matterport3D scene: ``*.house``, and its triangles' ``*_semantic.ply``.

A line of ``*.house``, version ASCII 1.1, is a record; its first letter is the kind. Like
habitat-sim (Mp3dSemanticScene.cpp), this reads regions, categories and objects::

    R region level 0 0 label  px py pz …
    C category mapping_index mapping_name mpcat40_index mpcat40_name …
    O object region category  px py pz …

Each triangle of the binary PLY has the number of its object (habitat-sim,
GenericInstanceMeshData.cpp). It is z up, like the drawn mesh.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Int64

from hypernav.core.errors import SceneError
from hypernav.io.reading import read_file, text_of
from hypernav.simulator.worlds.scans.scan_annotations import (
    MOST_POINTS,
    Annotation,
    nearest_marks,
    spread_points,
)

HEADER = "ASCII 1.1"

_MOST_HOUSE_BYTES = 200_000_000
"""Largest size of a file; the largest house has some 20 MB, mostly segments."""
_NOTHING = "unknown"
_MOST_MESH_BYTES = 1_000_000_000
_MOST_HEADER_BYTES = 10_000
_END = b"end_header\n"
_TYPES = {
    **{"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1"},
    **{"short": "<i2", "int16": "<i2", "ushort": "<u2", "uint16": "<u2"},
    **{"int": "<i4", "int32": "<i4", "uint": "<u4", "uint32": "<u4"},
    **{"float": "<f4", "float32": "<f4", "double": "<f8", "float64": "<f8"},
}
_INDICES = ("vertex_indices", "vertex_index")


def read_house(path: Path) -> list[Annotation]:
    """Read the objects of a scene; an object's mark is its number.

    An object is named as in the episode files, by level, region and number: ``0_4_89``. Its
    category is that of ObjectNav (mpcat40), and the annotator's own word is a further name.

    Args:
        path: A ``*.house`` file.

    Raises:
        SceneError: The file cannot be read, or a line is no record.
    """
    try:
        text = text_of(read_file(path, most=_MOST_HOUSE_BYTES), errors="replace")
    except OSError as error:
        raise SceneError(f"{path}: cannot be read ({error.strerror or error})") from error
    header, *lines = text.splitlines() or [""]
    if header.strip() != HEADER:
        raise SceneError(
            f"{path}: holds no annotations: expected the first line {HEADER!r}, got {header!r:.60}"
        )
    levels: dict[int, int] = {}
    categories: dict[int, tuple[str, str]] = {}
    found: dict[int, Annotation] = {}
    for number, line in enumerate(lines, start=2):
        fields = line.split()
        try:
            match fields[:1]:
                case ["R"]:
                    levels[int(fields[1])] = int(fields[2])
                case ["C"]:
                    categories[int(fields[1])] = _words(fields[5]), _words(fields[3])
                case ["O"]:
                    annotation = _object(fields, levels, categories)
                    found.setdefault(annotation.id, annotation)
        except (ValueError, IndexError) as error:
            raise SceneError(
                f"{path}: line {number} is no record of a house: {line!r:.80}; download the file "
                "again"
            ) from error
    return list(found.values())


def _object(
    fields: Sequence[str], levels: dict[int, int], categories: dict[int, tuple[str, str]]
) -> Annotation:
    number, region, category = (int(field) for field in fields[1:4])
    if number < 0:
        raise ValueError("objects are counted from 0")
    name = f"{levels[region]}_{region}_{number}" if region in levels else f"_{number}"
    common, own = categories.get(category, (_NOTHING, _NOTHING))
    return Annotation(number, number, name, common, () if own == common else (own,))


def _words(name: str) -> str:
    """A category with spaces in place of ``#`` and ``_``."""
    return name.replace("#", " ").replace("_", " ").strip() or _NOTHING


class _Element(NamedTuple):
    """One kind of records: their number and their fields."""

    name: str
    length: int
    item: np.dtype


def objects_of_triangles(
    path: Path, vertices: Float32[np.ndarray, "vertices 3"], faces: np.ndarray
) -> Int64[np.ndarray, "faces"]:
    """The number of the object that every drawn triangle belongs to.

    Args:
        path: The semantic mesh, ``*_semantic.ply``.
        vertices: Positions of the drawn mesh, scene frame, metres.
        faces: Vertex numbers of its triangles.

    Returns:
        Numbers; `scan_annotations.NO_MARK` where the semantic mesh is farther away than 0.25 m.

    Raises:
        SceneError: The semantic mesh is broken.
    """
    try:
        content = read_file(path, most=_MOST_MESH_BYTES)
    except OSError as error:
        raise SceneError(f"{path}: cannot be read ({error.strerror or error})") from error
    try:
        records = _records(content)
        points, triangles = records["vertex"], records["face"]
        corners = _corners(points, triangles)
        numbers = triangles["object_id"].astype(np.int64)
    except (ValueError, KeyError) as error:
        raise SceneError(
            f"{path}: is no semantic mesh of Matterport3D ({error}); download it again"
        ) from error
    spread = spread_points(path, corners, MOST_POINTS)
    return nearest_marks(spread.points, numbers[spread.face], vertices, faces)


def _records(content: bytes) -> dict[str, np.ndarray]:
    """All records of a file, by the name of their element."""
    end = content.find(_END, 0, _MOST_HEADER_BYTES)
    if not content.startswith(b"ply") or end < 0:
        raise ValueError("expected a PLY file")
    begin = end + len(_END)
    found: dict[str, np.ndarray] = {}
    for element in _elements(content[:end].decode("ascii", errors="replace").splitlines()):
        size = element.length * element.item.itemsize
        if size > len(content) - begin:
            raise ValueError(f"expected {size:,} bytes of '{element.name}', got fewer")
        found[element.name] = np.frombuffer(content, element.item, element.length, begin)
        begin += size
    return found


def _elements(lines: list[str]) -> list[_Element]:
    """The elements of a header. Lists have three items: all faces are triangles."""
    declared: list[tuple[str, int, list[tuple]]] = []
    for line in lines:
        match line.split():
            case ["format", kind, _] if kind != "binary_little_endian":
                raise ValueError(f"expected the format binary_little_endian, got {kind}")
            case ["element", name, count]:
                declared.append((name, int(count), []))
            case ["property", "list", length, item, name] if declared:
                count = (f"{name} count", _TYPES[length])
                declared[-1][2].extend([count, (name, _TYPES[item], 3)])
            case ["property", item, name] if declared:
                declared[-1][2].append((name, _TYPES[item]))
    if any(count < 0 for _, count, _ in declared):
        raise ValueError("expected counts from 0 on")
    return [_Element(name, count, np.dtype(fields)) for name, count, fields in declared]


def _corners(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Corners of all triangles, ``[faces, 3, 3]``, metres."""
    name = next((name for name in _INDICES if name in (triangles.dtype.names or ())), _INDICES[0])
    indices = triangles[name].astype(np.int64)
    if (triangles[f"{name} count"] != 3).any():
        raise ValueError("expected triangles")
    if len(indices) == 0 or indices.min() < 0 or indices.max() >= len(points):
        raise ValueError("expected vertex numbers that are there")
    return np.stack([points[axis] for axis in "xyz"], axis=1).astype(np.float64)[indices]
