"""Pieces of a scene, as read from files, and how they become one scene."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Int32, UInt8

from hypernav.core.errors import SceneError
from hypernav.core.labels import ObjectLabel
from hypernav.worlds.scenes.scene import Instance, Material, Scene

_CREASE_DEG = 40.0


@dataclass(frozen=True, eq=False)
class Piece:
    """Triangles of one material that belong to one node of a file; scene frame, metres.

    Attributes:
        node: Name of the node, unique within the file.
        title: Name that says best what it is; often the node's own.
        vertices: Corners.
        faces: Vertex numbers, counter-clockwise seen from outside.
        material: Number in the scene's materials.
        uv: Texture coordinates of every corner (v upwards).
        colors: sRGB colour of every corner.
        normals: Unit normal of every corner.
    """

    node: str
    title: str
    vertices: Float32[np.ndarray, "vertices 3"]
    faces: Int32[np.ndarray, "faces 3"]
    material: int
    uv: Float32[np.ndarray, "faces 3 2"] | None = None
    colors: UInt8[np.ndarray, "faces 3 3"] | None = None
    normals: Float32[np.ndarray, "faces 3 3"] | None = None


@dataclass(frozen=True)
class Thing:
    """An instance to be: which nodes it consists of and what it is."""

    name: str
    nodes: frozenset[str]
    label: ObjectLabel | None


def assemble(
    name: str,
    pieces: Sequence[Piece],
    things: Sequence[Thing],
    materials: Sequence[Material],
    *,
    smooth: bool = True,
) -> Scene:
    """Put pieces together to a scene.

    Triangles with a corner that is not a number are left out. Where a piece has no normals, edges
    flatter than 40° are smoothed.

    Args:
        name: Of the scene.
        pieces: Its triangles.
        things: Its instances; every piece's node belongs to exactly one.
        materials: What `Piece.material` counts.
        smooth: Whether normals are wanted at all; False shades every face flat.

    Raises:
        SceneError: Not one triangle is left.
    """
    owner = {node: number for number, thing in enumerate(things) for node in thing.nodes}
    kept = [clean for piece in pieces if len((clean := _without_bad_faces(piece)).faces)]
    if not kept:
        raise SceneError(f"{name}: holds no triangles; export a mesh with faces")
    counts = [len(piece.faces) for piece in kept]
    starts = np.concatenate([[0], np.cumsum([len(piece.vertices) for piece in kept])[:-1]])
    order = sorted({owner[piece.node] for piece in kept})
    number = {thing: place for place, thing in enumerate(order)}
    of_piece = [number[owner[piece.node]] for piece in kept]
    used = {piece.material for piece in kept}
    return Scene(
        name=name,
        vertices=np.concatenate([piece.vertices for piece in kept]),
        faces=np.concatenate(
            [piece.faces + np.int32(start) for piece, start in zip(kept, starts, strict=True)]
        ),
        uv=np.concatenate([_or_zeros(piece.uv, len(piece.faces)) for piece in kept]),
        colors=np.concatenate([_or_white(piece.colors, len(piece.faces)) for piece in kept]),
        normals=np.concatenate([_normals(piece) for piece in kept]) if smooth else None,
        face_material=np.repeat(np.array([p.material for p in kept], np.int32), counts),
        face_instance=np.repeat(np.array(of_piece, np.int32), counts),
        materials=tuple(materials),
        instances=_instances([things[index] for index in order], kept, of_piece),
        unlit=all(materials[index].unlit for index in used),
    )


def _without_bad_faces(piece: Piece) -> Piece:
    """The piece without triangles that have a corner at infinity or nowhere."""
    good = np.all(np.isfinite(piece.vertices), axis=1)
    if good.all():
        return piece
    keep = np.all(good[piece.faces], axis=1)
    return Piece(
        node=piece.node,
        title=piece.title,
        vertices=np.where(good[:, None], piece.vertices, np.float32(0.0)),
        faces=piece.faces[keep],
        material=piece.material,
        uv=None if piece.uv is None else piece.uv[keep],
        colors=None if piece.colors is None else piece.colors[keep],
        normals=None if piece.normals is None else piece.normals[keep],
    )


def _instances(
    things: Sequence[Thing], pieces: Sequence[Piece], of_piece: Sequence[int]
) -> tuple[Instance, ...]:
    low = np.full((len(things), 3), np.inf)
    high = np.full((len(things), 3), -np.inf)
    for piece, number in zip(pieces, of_piece, strict=True):
        corners = piece.vertices[piece.faces.ravel()]
        low[number] = np.minimum(low[number], corners.min(axis=0))
        high[number] = np.maximum(high[number], corners.max(axis=0))
    return tuple(
        Instance(number, thing.name, thing.label, _point(low[number]), _point(high[number]))
        for number, thing in enumerate(things)
    )


def _point(values: np.ndarray) -> tuple[float, float, float]:
    return (float(values[0]), float(values[1]), float(values[2]))


def _or_zeros(uv: np.ndarray | None, faces: int) -> np.ndarray:
    return uv if uv is not None else np.zeros((faces, 3, 2), dtype=np.float32)


def _or_white(colors: np.ndarray | None, faces: int) -> np.ndarray:
    return colors if colors is not None else np.full((faces, 3, 3), 255, dtype=np.uint8)


def _normals(piece: Piece) -> Float32[np.ndarray, "faces 3 3"]:
    if piece.normals is not None:
        return piece.normals
    return creased_normals(piece.vertices, piece.faces)


def creased_normals(
    vertices: Float32[np.ndarray, "vertices 3"], faces: Int32[np.ndarray, "faces 3"]
) -> Float32[np.ndarray, "faces 3 3"]:
    """Normals of corners from the triangles alone: smooth over flat edges, sharp over steep ones.

    A corner takes the mean of all faces that meet there, larger ones counting more, unless that
    leans more than 40° from its own face. Zero for triangles without area.
    """
    a, b, c = (vertices[faces[:, corner]].astype(np.float64) for corner in range(3))
    areas = np.cross(b - a, c - a)
    flat = areas / np.maximum(np.linalg.norm(areas, axis=1, keepdims=True), 1e-30)
    _, same = np.unique(vertices.view("V12").ravel(), return_inverse=True)
    sums = np.zeros((int(same.max()) + 1, 3))
    corners = same[faces]
    for corner in range(3):
        np.add.at(sums, corners[:, corner], areas)
    mean = sums / np.maximum(np.linalg.norm(sums, axis=1, keepdims=True), 1e-30)
    smooth = mean[corners]
    near = np.einsum("fck,fk->fc", smooth, flat) > math.cos(math.radians(_CREASE_DEG))
    return np.where(near[..., None], smooth, flat[:, None, :]).astype(np.float32)
