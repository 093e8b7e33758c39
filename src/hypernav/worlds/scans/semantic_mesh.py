"""The instances of a scan's triangles, from the colours of its semantic mesh.

HM3D marks instances by colour: v0.1 by the colours of the vertices (habitat-sim,
GenericSemanticMeshData.cpp, ``buildSemanticMeshData``), v0.2 by those of textures
(ResourceManager.cpp, ``convertRGBToSemanticId``; ``has_semantic_textures`` in its scene-dataset
configuration).
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float32, Float64, Int64

from hypernav.core.errors import SceneError
from hypernav.worlds.scans.nearest_marks import (
    MOST_POINTS,
    NO_MARK,
    nearest_marks,
    spread_points,
)
from hypernav.worlds.scenes.gltf import read_gltf
from hypernav.worlds.scenes.scene import Material
from hypernav.worlds.scenes.scene_assembly import MeshPart


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
