"""The instances of a scan's triangles, from the colours of its semantic mesh.

HM3D marks instances by colour: v0.1 by the colours of the vertices (habitat-sim,
GenericSemanticMeshData.cpp, ``buildSemanticMeshData``), v0.2 by those of textures
(ResourceManager.cpp, ``convertRGBToSemanticId``; ``has_semantic_textures`` in its scene-dataset
configuration). The semantic mesh need not have the triangles of the drawn one. So points are spread
over it, and every drawn triangle takes the colour of the point that is nearest to its middle.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float32, Float64, Int64
from scipy.spatial import KDTree

from hypernav.core.errors import SceneError
from hypernav.worlds.scenes.gltf import read_gltf
from hypernav.worlds.scenes.scene import Material
from hypernav.worlds.scenes.scene_assembly import MeshPart

NO_COLOR = -1
"""What stands for the colour of a triangle that the semantic mesh is nowhere near to."""

_SPACING_M = 0.05
_REACH_M = 0.25
_MOST_POINTS = 8_000_000
_GOLDEN = 1.324717957244746
"""Fractions of the two-dimensional golden ratio are spread evenly, however many are taken."""


def colors_of_triangles(
    path: Path,
    known: frozenset[int],
    vertices: Float32[np.ndarray, "vertices 3"],
    faces: np.ndarray,
) -> Int64[np.ndarray, "faces"]:
    """The annotated colour of every drawn triangle.

    Vertex colours of a glTF file are linear light, and habitat-sim converts them to sRGB. Files
    whose numbers are the codes themselves are recognised by the colours that are annotated.

    Args:
        path: The semantic mesh, ``*.semantic.glb``.
        known: Colours ``0xRRGGBB`` that are annotated.
        vertices: Positions of the drawn mesh, scene frame, metres.
        faces: Vertex numbers of its triangles.

    Returns:
        Colours ``0xRRGGBB``; `NO_COLOR` where the semantic mesh is farther than 0.25 m.

    Raises:
        SceneError: The semantic mesh is broken.
    """
    parts, materials = _read(path)
    points, colors = _points(path, parts, materials)
    if any(part.colors is not None for part in parts) and _share(colors, known) < 0.5:
        again, _ = _read(path, color_codes=True)
        codes = _points(path, again, materials)[1]
        colors = codes if _share(codes, known) > _share(colors, known) else colors
    middles = vertices[faces].mean(axis=1, dtype=np.float64)
    tree = KDTree(points, balanced_tree=False, compact_nodes=False)
    _, nearest = tree.query(middles, distance_upper_bound=_REACH_M)
    return np.append(colors, NO_COLOR)[nearest]


def _read(path: Path, *, color_codes: bool = False) -> tuple[list[MeshPart], list[Material]]:
    try:
        parts, materials = read_gltf(path, z_up=True, color_codes=color_codes)
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
    left = _MOST_POINTS
    for part in parts:
        corners = part.vertices[part.faces].astype(np.float64)
        whole = np.flatnonzero(np.isfinite(corners).all(axis=(1, 2)))
        more = _points_of_faces(corners[whole])
        left -= len(whole) + int(more.sum())
        if left < 0:
            raise SceneError(
                f"{path}: its surface is too large for a building; are its units metres?"
            )
        place, weights = _spread(more)
        face = whole[place]
        points.append(np.einsum("nk,nkd->nd", weights, corners[face]))
        colors.append(_colors(part, materials[part.material], face, weights))
    return np.concatenate(points), np.concatenate(colors)


def _points_of_faces(corners: Float64[np.ndarray, "faces 3 3"]) -> Int64[np.ndarray, "faces"]:
    """Numbers of points besides the middle that faces get for their size."""
    sides = corners[:, 1:] - corners[:, :1]
    areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) / 2.0
    return np.minimum(areas / _SPACING_M**2, float(_MOST_POINTS)).astype(np.int64)


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


def _colors(
    part: MeshPart,
    material: Material,
    face: Int64[np.ndarray, "n"],
    weights: Float64[np.ndarray, "n 3"],
) -> Int64[np.ndarray, "n"]:
    """Colours of points: of their texel, else of the nearest corner."""
    if part.uv is not None and material.texture is not None:
        height, width = material.texture.shape[:2]
        uv = np.einsum("nk,nkd->nd", weights, part.uv[face].astype(np.float64)) % 1.0
        column = np.minimum((uv[:, 0] * width).astype(np.int64), width - 1)
        row = np.minimum(((1.0 - uv[:, 1]) * height).astype(np.int64), height - 1)
        codes = material.texture[row, column]
    elif part.colors is not None:
        codes = part.colors[face, weights.argmax(axis=1)]
    else:
        return np.full(len(face), NO_COLOR, dtype=np.int64)
    red, green, blue = codes.astype(np.int64).T
    return red << 16 | green << 8 | blue
