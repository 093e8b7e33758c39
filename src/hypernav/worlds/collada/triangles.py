"""Triangles of the meshes in a COLLADA document."""

import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Float64, Int64

from hypernav.worlds.scenes.polygons import triangles_of_polygons

_KINDS = ("triangles", "polylist", "polygons", "tristrips", "trifans")


@dataclass(frozen=True, eq=False)
class Triangles:
    """Triangles of one material, in the frame of their mesh.

    Attributes:
        symbol: Name that the material has within the mesh; empty without one.
        vertices: Positions.
        faces: Vertex numbers.
        uv: Texture coordinates of every corner (v upwards).
        normals: Normals of every corner, of any length.
        colors: sRGB colour of every corner, 0 to 1.
    """

    symbol: str
    vertices: Float64[np.ndarray, "vertices 3"]
    faces: Int64[np.ndarray, "faces 3"]
    uv: Float32[np.ndarray, "faces 3 2"] | None = None
    normals: Float64[np.ndarray, "faces 3 3"] | None = None
    colors: Float64[np.ndarray, "faces 3 3"] | None = None


def triangles_of(mesh: ElementTree.Element) -> Iterator[Triangles]:
    """All triangles of a mesh; lines and points are left out.

    Args:
        mesh: An element ``mesh``.

    Raises:
        ValueError: It holds something that is no number, or refers to what isn't there.
    """
    sources = {source.get("id", ""): source for source in mesh.iter("source")}
    of_vertices = {
        vertices.get("id", ""): list(vertices.iter("input")) for vertices in mesh.iter("vertices")
    }
    arrays: dict[str, Float64[np.ndarray, "n width"]] = {}
    for primitive in mesh:
        if primitive.tag not in _KINDS:
            continue
        inputs = _inputs(primitive, of_vertices)
        if "POSITION" not in inputs:
            continue
        offsets = [int(item.get("offset", "0")) for item in primitive.iter("input")]
        if min(offsets) < 0:
            raise ValueError("an input has a negative offset")
        width = 1 + max(offsets)
        source, offset = inputs["POSITION"]
        if source not in arrays:
            arrays[source] = _array(sources, source)
        corners = _corners(primitive, width, _first(arrays[source], 3), offset)
        if not len(corners):
            continue
        read: dict[str, tuple[Float64[np.ndarray, "n width"], Int64[np.ndarray, "faces 3"]]] = {}
        for semantic, (source, offset) in inputs.items():
            if source not in arrays:
                arrays[source] = _array(sources, source)
            numbers = corners[:, :, offset]
            if numbers.min() < 0 or numbers.max() >= len(arrays[source]):
                raise ValueError(f"a triangle uses a {semantic} that is not there")
            read[semantic] = (arrays[source], numbers)
        positions, faces = read["POSITION"]
        yield Triangles(
            primitive.get("material", ""),
            _first(positions, 3),
            faces,
            _of_corners(read, "TEXCOORD", 2, np.float32),
            _of_corners(read, "NORMAL", 3, np.float64),
            _of_corners(read, "COLOR", 3, np.float64),
        )


def numbers_of(text: str | None) -> Float64[np.ndarray, "n"]:
    """The numbers in a text.

    Raises:
        ValueError: Something is no number.
    """
    return np.fromiter(map(float, (text or "").split()), np.float64)


def _inputs(
    primitive: ElementTree.Element, of_vertices: dict[str, list[ElementTree.Element]]
) -> dict[str, tuple[str, int]]:
    """Source and offset of each kind of value; of several sets the first."""
    found: dict[str, tuple[str, int]] = {}
    for item in primitive.iter("input"):
        source, offset = item.get("source", "")[1:], int(item.get("offset", "0"))
        if item.get("semantic") == "VERTEX":
            for inner in of_vertices.get(source, []):
                found.setdefault(inner.get("semantic", ""), (inner.get("source", "")[1:], offset))
        else:
            found.setdefault(item.get("semantic", ""), (source, offset))
    known = ("POSITION", "TEXCOORD", "NORMAL", "COLOR")
    return {semantic: found[semantic] for semantic in known if semantic in found}


def _array(sources: dict[str, ElementTree.Element], name: str) -> Float64[np.ndarray, "n width"]:
    source = sources.get(name)
    array = None if source is None else source.find("float_array")
    if source is None or array is None:
        raise ValueError(f"the source {name:.80} is not there")
    accessor = source.find("technique_common/accessor")
    values = numbers_of(array.text)
    if accessor is None:
        raise ValueError(f"the source {name:.80} has no accessor")
    width, start = int(accessor.get("stride", "1")), int(accessor.get("offset", "0"))
    if width < 1 or start < 0:
        raise ValueError(f"the accessor of {name:.80} steps by {width} from {start}")
    values = values[start:]
    return values[: len(values) // width * width].reshape(-1, width)


def _corners(
    primitive: ElementTree.Element,
    width: int,
    positions: Float64[np.ndarray, "n 3"],
    offset: int,
) -> Int64[np.ndarray, "faces 3 width"]:
    """Numbers of every value of every corner of the triangles; a position's is at the offset."""
    runs = [_whole_numbers(item.text) for item in primitive.iter("p")]
    runs = [run[: len(run) // width * width].reshape(-1, width) for run in runs]
    if not runs:
        return np.zeros((0, 3, width), np.int64)
    kind = primitive.tag
    if kind == "tristrips":
        return np.concatenate([_strip(run) for run in runs])
    together = np.concatenate(runs)
    if kind == "triangles":
        return together[: len(together) // 3 * 3].reshape(-1, 3, width)
    if kind == "polylist":
        counts = _whole_numbers(primitive.findtext("vcount"))
    else:
        counts = np.array([len(run) for run in runs])
    if (len(counts) and counts.min() < 0) or counts.sum() > len(together):
        raise ValueError("the polygons have more corners than are listed")
    together = together[: counts.sum()]
    used = together[:, offset]
    if len(used) and (used.min() < 0 or used.max() >= len(positions)):
        raise ValueError("a polygon uses a POSITION that is not there")
    return together[triangles_of_polygons(counts, positions[used])]


def _strip(run: Int64[np.ndarray, "n width"]) -> Int64[np.ndarray, "faces 3 width"]:
    if len(run) < 3:
        return np.zeros((0, 3, run.shape[1]), np.int64)
    strip = np.stack([run[:-2], run[1:-1], run[2:]], axis=1)
    strip[1::2] = strip[1::2, [1, 0, 2]]
    return strip


def _whole_numbers(text: str | None) -> Int64[np.ndarray, "n"]:
    try:
        return np.fromiter(map(int, (text or "").split()), np.int64)
    except OverflowError as error:
        raise ValueError("a number is too large") from error


def _of_corners(
    read: dict[str, tuple[np.ndarray, np.ndarray]], semantic: str, width: int, dtype: type
) -> np.ndarray | None:
    if semantic not in read or read[semantic][0].shape[1] < width:
        return None
    values, numbers = read[semantic]
    return np.nan_to_num(values[:, :width]).astype(dtype)[numbers]


def _first(values: Float64[np.ndarray, "n width"], width: int) -> Float64[np.ndarray, "n w"]:
    if values.shape[1] < width:
        raise ValueError(f"positions have {values.shape[1]} numbers, expected {width}")
    return np.ascontiguousarray(values[:, :width])
