"""The annotations of an HM3D scene: ``*.semantic.txt``, and the instances of the scan's triangles.

HM3D marks instances by colour: v0.1 by the colours of the vertices (habitat-sim,
GenericSemanticMeshData.cpp, ``buildSemanticMeshData``), v0.2 by those of textures
(ResourceManager.cpp, ``convertRGBToSemanticId``; ``has_semantic_textures`` in its scene-dataset
configuration).

The annotated mesh need not have the triangles of the drawn one. So points are spread over it, and
every drawn triangle gets the mark (a colour or a number) of the point nearest to its centre.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Float64, Int64

from hypernav.core.errors import SceneError
from hypernav.io.reading import read_file, text_of
from hypernav.simulator.worlds.scenes.gltf import read_gltf
from hypernav.simulator.worlds.scenes.mesh_parts import MeshPart
from hypernav.simulator.worlds.scenes.scene import Material

NO_MARK = -1
"""Mark of a triangle that is far from the annotated mesh."""
MOST_POINTS = 8_000_000

_SPACING_M = 0.05
_REACH_M = 0.25
_GOLDEN = 1.324717957244746
"""Multiples of the two-dimensional golden ratio, modulo 1, are spread evenly for any number."""
HEADER = "HM3D Semantic Annotations"
_MOST_BYTES = 20_000_000
_MOST_ANNOTATIONS = 65_535
"""habitat-sim keeps the numbers of instances in 16 bits."""


class Spread(NamedTuple):
    """Points on triangles.

    Attributes:
        points: Positions.
        face: Triangle of every point.
        weights: Shares of its corners.
    """

    points: Float64[np.ndarray, "n 3"]
    face: Int64[np.ndarray, "n"]
    weights: Float64[np.ndarray, "n 3"]


def nearest_marks(
    points: Float64[np.ndarray, "n 3"],
    marks: Int64[np.ndarray, "n"],
    vertices: Float32[np.ndarray, "vertices 3"],
    faces: np.ndarray,
) -> Int64[np.ndarray, "faces"]:
    """The mark of the point that is nearest to the middle of every triangle.

    Args:
        points: Points on the annotated mesh, scene frame, metres.
        marks: Their marks.
        vertices: Positions of the drawn mesh, scene frame, metres.
        faces: Vertex numbers of its triangles.

    Returns:
        Marks; `NO_MARK` where no point is within 0.25 m.
    """
    from scipy.spatial import KDTree  # imported here, because only scans need it and it takes time

    middles = vertices[faces].mean(axis=1, dtype=np.float64)
    tree = KDTree(points, balanced_tree=False, compact_nodes=False)
    _, nearest = tree.query(middles, distance_upper_bound=_REACH_M)
    return np.append(marks, NO_MARK)[nearest]


def spread_points(path: Path, corners: Float64[np.ndarray, "faces 3 3"], most: int) -> Spread:
    """Points 5 cm apart on triangles, at least the middle of each.

    Args:
        path: File of the triangles, for the error.
        corners: Corners of the triangles, metres; those with non-finite corners get no point.
        most: Largest number of points.

    Raises:
            SceneError: The triangles would need more points.
    """
    whole = np.flatnonzero(np.isfinite(corners).all(axis=(1, 2)))
    more = _points_of_faces(corners[whole])
    if len(whole) + int(more.sum()) > most:
        raise SceneError(f"{path}: its surface is too large for a building; are its units metres?")
    place, weights = _spread(more)
    face = whole[place]
    return Spread(np.einsum("nk,nkd->nd", weights, corners[face]), face, weights)


def _points_of_faces(corners: Float64[np.ndarray, "faces 3 3"]) -> Int64[np.ndarray, "faces"]:
    """Numbers of points besides the centre that faces get by their size."""
    sides = corners[:, 1:] - corners[:, :1]
    areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) / 2.0
    return np.minimum(areas / _SPACING_M**2, float(MOST_POINTS)).astype(np.int64)


def _spread(
    more: Int64[np.ndarray, "faces"],
) -> tuple[Int64[np.ndarray, "n"], Float64[np.ndarray, "n 3"]]:
    """Faces and barycentric weights of points, the middles of all faces first."""
    face = np.repeat(np.arange(len(more)), more)
    place = np.arange(len(face)) - np.repeat(np.cumsum(more) - more, more) + 1
    u, v = (place / _GOLDEN) % 1.0, (place / _GOLDEN**2) % 1.0
    folded = u + v > 1.0
    u, v = np.where(folded, 1.0 - u, u), np.where(folded, 1.0 - v, v)
    middles = np.full((len(more), 3), 1.0 / 3.0)
    weights = np.concatenate([middles, np.column_stack([1.0 - u - v, u, v])])
    return np.concatenate([np.arange(len(more)), face]), weights


@dataclass(frozen=True)
class Annotation:
    """One instance of a scan.

    Attributes:
        id: Number in the file; episode files identify their goals by it.
        mark: Mark of the instance in the semantic mesh: a colour ``0xRRGGBB``, or a number.
        name: Name of the instance, composed as by habitat-sim.
        category: Category in the annotator's own words.
        synonyms: Further names of the category.
    """

    id: int
    mark: int
    name: str
    category: str
    synonyms: tuple[str, ...] = ()


def read_annotations(path: Path) -> list[Annotation]:
    """Read the annotations of a scene.

    After the header every line is ``id,RRGGBB,"category",region``. A category may contain commas
    and quotes, so everything between the second and the last comma is the category. If two lines
    have the same colour, the first counts, as in habitat-sim (HM3DSemanticScene.cpp).

    Args:
        path: A ``*.semantic.txt`` file.

    Raises:
        SceneError: The file cannot be read, or a line is no annotation.
    """
    try:
        text = text_of(read_file(path, most=_MOST_BYTES), errors="replace")
    except OSError as error:
        raise SceneError(f"{path}: cannot be read ({error.strerror or error})") from error
    header, *lines = text.splitlines() or [""]
    if HEADER not in header:
        raise SceneError(
            f"{path}: holds no annotations: expected the first line {HEADER!r}, got {header!r:.60}"
        )
    if len(lines) > _MOST_ANNOTATIONS:
        raise SceneError(
            f"{path}: has {len(lines):,} lines, at most {_MOST_ANNOTATIONS:,} are read; is it the "
            "annotation of one scene?"
        )
    found: dict[int, Annotation] = {}
    for number, line in enumerate(lines, start=2):
        if line.strip():
            annotation = _annotation(path, number, line)
            found.setdefault(annotation.mark, annotation)
    return list(found.values())


def _annotation(path: Path, number: int, line: str) -> Annotation:
    head, comma, region = line.rpartition(",")
    try:
        identity, color, category = head.split(",", maxsplit=2)
        if not comma or len(color.strip()) != 6:
            raise ValueError("too few commas, or no colour")
        int(region)
        own = _unquoted(category)
        return Annotation(int(identity), int(color, 16), f"{own}_{int(identity)}", own)
    except ValueError as error:
        raise SceneError(
            f'{path}: line {number} is no annotation: expected id,RRGGBB,"category",region, got '
            f"{line!r:.80}; download the file again"
        ) from error


def _unquoted(category: str) -> str:
    """The category without surrounding quotes; doubled quotes inside become one."""
    text = category.strip()
    if len(text) >= 2 and text[0] == text[-1] == '"':
        text = text[1:-1]
    return text.replace('""', '"').strip() or "unknown"


def colors_of_triangles(
    path: Path,
    known: frozenset[int],
    vertices: Float32[np.ndarray, "vertices 3"],
    faces: np.ndarray,
) -> Int64[np.ndarray, "faces"]:
    """The annotated colour of every drawn triangle.

    Vertex colours of a glTF file are linear light, and habitat-sim converts them to sRGB. Files
    that store sRGB codes instead are recognised by the annotated colours.

    Args:
        path: The semantic mesh, ``*.semantic.glb``.
        known: Colours ``0xRRGGBB`` that are annotated.
        vertices: Positions of the drawn mesh, scene frame, metres.
        faces: Vertex numbers of its triangles.

    Returns:
        Colours ``0xRRGGBB``; `NO_MARK` where the semantic mesh is farther away than 0.25 m.

    Raises:
        SceneError: The semantic mesh is broken.
    """
    parts, materials = _read(path)
    points, colors = _points(path, parts, materials)
    if any(part.colors is not None for part in parts) and _share(colors, known) < 0.5:
        again, _ = _read(path, color_codes=True)
        codes = _points(path, again, materials)[1]
        colors = codes if _share(codes, known) > _share(colors, known) else colors
    return nearest_marks(points, colors, vertices, faces)


def _read(path: Path, *, color_codes: bool = False) -> tuple[list[MeshPart], list[Material]]:
    try:
        parts, materials = read_gltf(path, up="z", color_codes=color_codes)
    except OSError as error:
        raise SceneError(f"{path}: cannot be read ({error.strerror or error})") from error
    if not any(len(part.faces) for part in parts):
        raise SceneError(f"{path}: holds no triangles; download it again")
    return parts, materials


def _share(colors: Int64[np.ndarray, "n"], known: frozenset[int]) -> float:
    return float(np.isin(colors, np.array(sorted(known), dtype=np.int64)).mean())


def _points(
    path: Path, parts: Sequence[MeshPart], materials: Sequence[Material]
) -> tuple[Float64[np.ndarray, "n 3"], Int64[np.ndarray, "n"]]:
    """Points spread over the semantic mesh, and their colours."""
    points, colors = [], []
    left = MOST_POINTS
    for part in parts:
        corners = part.vertices[part.faces].astype(np.float64)
        spread = spread_points(path, corners, left)
        left -= len(spread.points)
        points.append(spread.points)
        colors.append(_colors(part, materials[part.material], spread.face, spread.weights))
    return np.concatenate(points), np.concatenate(colors)


def _colors(
    part: MeshPart,
    material: Material,
    face: Int64[np.ndarray, "n"],
    weights: Float64[np.ndarray, "n 3"],
) -> Int64[np.ndarray, "n"]:
    """Colours of points: of their texel if there is a texture, else of the nearest corner."""
    if part.uv is not None and material.texture is not None:
        height, width = material.texture.shape[:2]
        uv = np.einsum("nk,nkd->nd", weights, part.uv[face].astype(np.float64)) % 1.0
        column = np.minimum((uv[:, 0] * width).astype(np.int64), width - 1)
        row = np.minimum(((1.0 - uv[:, 1]) * height).astype(np.int64), height - 1)
        codes = material.texture[row, column]
    elif part.colors is not None:
        codes = part.colors[face, weights.argmax(axis=1)]
    else:
        return np.full(len(face), NO_MARK, dtype=np.int64)
    red, green, blue = codes.astype(np.int64).T
    return red << 16 | green << 8 | blue
