"""The instances of a Matterport3D scene's triangles: ``*_semantic.ply``.

Each triangle of this binary PLY has the number of its object (habitat-sim,
GenericInstanceMeshData.cpp). It is z up, like the drawn mesh.
"""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Int64

from hypernav.core.errors import SceneError
from hypernav.io.reading import read_file
from hypernav.worlds.scans.nearest_marks import MOST_POINTS, nearest_marks, spread_points

_MOST_BYTES = 1_000_000_000
_MOST_HEADER_BYTES = 10_000
_END = b"end_header\n"
_TYPES = {
    **{"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1"},
    **{"short": "<i2", "int16": "<i2", "ushort": "<u2", "uint16": "<u2"},
    **{"int": "<i4", "int32": "<i4", "uint": "<u4", "uint32": "<u4"},
    **{"float": "<f4", "float32": "<f4", "double": "<f8", "float64": "<f8"},
}
_INDICES = ("vertex_indices", "vertex_index")


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
        Numbers; `nearest_marks.NO_MARK` where the semantic mesh is farther away than 0.25 m.

    Raises:
        SceneError: The semantic mesh is broken.
    """
    try:
        content = read_file(path, most=_MOST_BYTES)
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
