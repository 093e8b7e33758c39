"""Mesh parts of files: their axes and polygons, and their assembly to one scene.

A polygon is cut into a fan of triangles where that is right, and ear by ear where it is not convex:
a wall with a doorway is often one polygon, and a fan would close the doorway.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
from jaxtyping import Bool, Float, Float32, Float64, Int, Int32, Int64, UInt8

from hypernav.core.errors import SceneError
from hypernav.core.naming.labels import ObjectLabel
from hypernav.core.world import Instance
from hypernav.simulator.worlds.config import Axis
from hypernav.simulator.worlds.scenes.scene import Material, Scene

_ROWS: dict[Axis, list[list[float]]] = {
    "x": [[0, -1, 0], [0, 0, -1], [1, 0, 0]],
    "y": [[1, 0, 0], [0, 0, -1], [0, 1, 0]],
    "z": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
    "-x": [[0, 1, 0], [0, 0, -1], [-1, 0, 0]],
    "-y": [[1, 0, 0], [0, 0, 1], [0, -1, 0]],
    "-z": [[1, 0, 0], [0, -1, 0], [0, 0, -1]],
}
TO_Z_UP: Mapping[Axis, Float64[np.ndarray, "3 3"]] = MappingProxyType(
    {axis: np.array(rows, dtype=np.float64) for axis, rows in _ROWS.items()}
)
"""The rotation from a file's frame, by the axis that is up in it, to the scene frame."""
_BACKWARDS = -1e-6
"""Cosine below which a triangle of a fan faces against its polygon."""
_MOST_CORNERS = 1000
"""Polygons with more corners stay fans."""
_CREASE_DEG = 40.0


def axis_along(direction: Float64[np.ndarray, "3"]) -> Axis:
    """The axis that a unit vector along one of them means."""
    return max(TO_Z_UP, key=lambda axis: float(TO_Z_UP[axis][2] @ direction))


def triangles_of_polygons(
    counts: Int64[np.ndarray, "polygons"], points: Float64[np.ndarray, "corners 3"]
) -> Int64[np.ndarray, "faces 3"]:
    """Numbers of the corners of triangles that cover polygons, without a new corner.

    Args:
        counts: Number of corners of every polygon; those with fewer than three have no triangle.
        points: Positions of their corners, one polygon after the other.
    """
    starts = np.cumsum(counts) - counts
    triangles = np.maximum(counts - 2, 0)
    polygon = np.repeat(np.arange(len(counts)), triangles)
    hub = np.repeat(starts, triangles)
    step = np.arange(len(hub)) - np.repeat(np.cumsum(triangles) - triangles, triangles)
    fans = np.stack([hub, hub + step + 1, hub + step + 2], axis=1).astype(np.int64)
    a, b, c = points[fans].transpose(1, 0, 2)
    with np.errstate(all="ignore"):  # a corner that is no number faces nowhere
        areas = np.cross(b - a, c - a)
        normals = np.zeros((len(counts), 3))
        np.add.at(normals, polygon, areas)
        sizes = np.linalg.norm(areas, axis=1) * np.linalg.norm(normals[polygon], axis=1)
        against = np.einsum("fk,fk->f", areas, normals[polygon]) < _BACKWARDS * sizes
    bent = np.unique(polygon[against])
    bent = bent[counts[bent] <= _MOST_CORNERS]
    ears = [
        starts[k] + _ears(points[starts[k] : starts[k] + counts[k]], normals[k])
        for k in bent.tolist()
    ]
    return np.concatenate([fans[~np.isin(polygon, bent)], *ears])


def _ears(
    points: Float64[np.ndarray, "n 3"], normal: Float64[np.ndarray, "3"]
) -> Int64[np.ndarray, "faces 3"]:
    """Triangles of one polygon: corners that nothing lies in are cut off, one after the other."""
    # The axis that the normal is farthest from gives the plane its first direction.
    right = np.cross(normal, np.eye(3)[int(np.abs(normal).argmin())])
    flat = points @ np.stack([right, np.cross(normal, right)], axis=1)
    left = list(range(len(points)))
    found: list[tuple[int, int, int]] = []
    while len(left) > 3:
        ear = next((k for k in range(len(left)) if _is_ear(flat, left, k)), None)
        if ear is None:  # it crosses itself: what is left stays a fan
            break
        found.append((left[ear - 1], left[ear], left[(ear + 1) % len(left)]))
        del left[ear]
    found += [(left[0], left[k], left[k + 1]) for k in range(1, len(left) - 1)]
    return np.array(found, dtype=np.int64)


def _is_ear(flat: Float64[np.ndarray, "n 2"], left: list[int], k: int) -> bool:
    a, b, c = flat[left[k - 1]], flat[left[k]], flat[left[(k + 1) % len(left)]]
    if _side(a, b, c[None])[0] <= 0.0:
        return False
    others = flat[left]
    inside = (_side(a, b, others) > 0.0) & (_side(b, c, others) > 0.0) & (_side(c, a, others) > 0.0)
    return not inside.any()


def _side(
    a: Float64[np.ndarray, "2"], b: Float64[np.ndarray, "2"], points: Float64[np.ndarray, "n 2"]
) -> Float64[np.ndarray, "n"]:
    """Positive for points to the left of the line from a to b."""
    (x, y), relative = b - a, points - a
    return x * relative[:, 1] - y * relative[:, 0]


@dataclass(frozen=True, eq=False)
class MeshPart:
    """Triangles of one material that belong to one node of a file; scene frame, metres.

    Attributes:
        node: Name of the node, unique within the file.
        descriptive_name: Most descriptive name among the node and its parents; often the node's.
        vertices: Vertex positions.
        faces: Vertex numbers, counter-clockwise seen from outside.
        material: Index in the scene's materials.
        uv: Texture coordinates of every corner (v upwards).
        colors: sRGB colour of every corner.
        normals: Unit normal of every corner.
    """

    node: str
    descriptive_name: str
    vertices: Float32[np.ndarray, "vertices 3"]
    faces: Int32[np.ndarray, "faces 3"]
    material: int
    uv: Float32[np.ndarray, "faces 3 2"] | None = None
    colors: UInt8[np.ndarray, "faces 3 3"] | None = None
    normals: Float32[np.ndarray, "faces 3 3"] | None = None

    def of_faces(self, keep: Bool[np.ndarray, "faces"] | Int[np.ndarray, "kept"]) -> "MeshPart":
        """The part with only some of its triangles, which a mask or their numbers say."""
        return replace(
            self,
            faces=self.faces[keep],
            uv=None if self.uv is None else self.uv[keep],
            colors=None if self.colors is None else self.colors[keep],
            normals=None if self.normals is None else self.normals[keep],
        )


def rotation_of(quaternion: Float[np.ndarray, "4"]) -> Float[np.ndarray, "3 3"]:
    """The rotation matrix of a quaternion ``[x, y, z, w]`` of any length."""
    x, y, z, w = quaternion / max(float(np.linalg.norm(quaternion)), 1e-12)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def placed(part: MeshPart, matrix: Float64[np.ndarray, "4 4"]) -> MeshPart:
    """A part moved by a transform; one that mirrors turns its triangles around as well."""
    linear, shift = matrix[:3, :3], matrix[:3, 3]
    determinant = np.linalg.det(linear)
    faces, uv, colors, normals = part.faces, part.uv, part.colors, part.normals
    # Corners that end at infinity or nowhere are left out when the scene is assembled.
    with np.errstate(all="ignore"):
        if normals is not None:
            normals = normals @ np.linalg.inv(linear) if abs(determinant) > 1e-30 else None
        if normals is not None:
            normals = np.nan_to_num(normals)
            normals /= np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), 1e-30)
            normals = normals.astype(np.float32)
        vertices = (part.vertices.astype(np.float64) @ linear.T + shift).astype(np.float32)
    if determinant < 0.0:
        faces = np.ascontiguousarray(faces[:, ::-1])
        uv = None if uv is None else uv[:, ::-1]
        colors = None if colors is None else colors[:, ::-1]
        normals = None if normals is None else normals[:, ::-1]
    return replace(part, vertices=vertices, faces=faces, uv=uv, colors=colors, normals=normals)


@dataclass(frozen=True)
class SceneObject:
    """An instance to be assembled: its nodes and its label."""

    name: str
    nodes: frozenset[str]
    label: ObjectLabel | None


def assemble(
    name: str,
    parts: Sequence[MeshPart],
    objects: Sequence[SceneObject],
    materials: Sequence[Material],
    *,
    smooth: bool = True,
) -> Scene:
    """Assemble mesh parts to a scene.

    Triangles with a non-finite corner are left out. If a part has no normals, edges flatter than
    40° are smoothed.

    Args:
        name: Name of the scene.
        parts: Triangles of the scene.
        objects: Instances of the scene; the node of every part belongs to exactly one of them.
        materials: Materials that `MeshPart.material` indexes.
        smooth: Whether to use normals; False shades every face flat.

    Raises:
        SceneError: No triangle is left.
    """
    owner = {node: number for number, item in enumerate(objects) for node in item.nodes}
    kept = [clean for part in parts if len((clean := _without_bad_faces(part)).faces)]
    if not kept:
        raise SceneError(f"{name}: holds no triangles; export a mesh with faces")
    counts = [len(part.faces) for part in kept]
    starts = np.concatenate([[0], np.cumsum([len(part.vertices) for part in kept])[:-1]])
    order = sorted({owner[part.node] for part in kept})
    number = {item: place for place, item in enumerate(order)}
    instance_of_part = np.array([number[owner[part.node]] for part in kept], np.int32)
    vertices = np.concatenate([part.vertices for part in kept])
    faces = np.concatenate(
        [part.faces + np.int32(start) for part, start in zip(kept, starts, strict=True)]
    )
    face_instance = np.repeat(instance_of_part, counts)
    named = [(objects[index].name, objects[index].label) for index in order]
    used = {part.material for part in kept}
    return Scene(
        name=name,
        vertices=vertices,
        faces=faces,
        uv=np.concatenate([_or_zeros(part.uv, len(part.faces)) for part in kept]),
        colors=np.concatenate([_or_white(part.colors, len(part.faces)) for part in kept]),
        normals=np.concatenate([_normals(part) for part in kept]) if smooth else None,
        face_material=np.repeat(np.array([p.material for p in kept], np.int32), counts),
        face_instance=face_instance,
        materials=tuple(materials),
        instances=instances_of(named, vertices[faces], face_instance),
        unlit=all(materials[index].unlit for index in used),
    )


def _without_bad_faces(part: MeshPart) -> MeshPart:
    """The part without triangles that have a non-finite corner."""
    good = np.all(np.isfinite(part.vertices), axis=1)
    if good.all():
        return part
    vertices = np.where(good[:, None], part.vertices, np.float32(0.0))
    return replace(part.of_faces(np.all(good[part.faces], axis=1)), vertices=vertices)


def instances_of(
    named: Sequence[tuple[str, ObjectLabel | None]],
    corners: Float32[np.ndarray, "faces 3 3"],
    face_instance: Int32[np.ndarray, "faces"],
) -> tuple[Instance, ...]:
    """Instances with the boxes of their triangles.

    Args:
        named: Name and label of every instance.
        corners: Corners of all triangles, scene frame, metres.
        face_instance: Instance of every triangle.
    """
    low, high = np.full((len(named), 3), np.inf), np.full((len(named), 3), -np.inf)
    np.minimum.at(low, face_instance, corners.min(axis=1))
    np.maximum.at(high, face_instance, corners.max(axis=1))
    return tuple(
        Instance(number, name, label, point_of(low[number]), point_of(high[number]))
        for number, (name, label) in enumerate(named)
    )


def point_of(values: np.ndarray) -> tuple[float, float, float]:
    """Three numbers of an array as a position."""
    x, y, z = values.tolist()
    return x, y, z


def _or_zeros(uv: np.ndarray | None, faces: int) -> np.ndarray:
    return uv if uv is not None else np.zeros((faces, 3, 2), dtype=np.float32)


def _or_white(colors: np.ndarray | None, faces: int) -> np.ndarray:
    return colors if colors is not None else np.full((faces, 3, 3), 255, dtype=np.uint8)


def _normals(part: MeshPart) -> Float32[np.ndarray, "faces 3 3"]:
    if part.normals is not None:
        return part.normals
    return creased_normals(part.vertices, part.faces)


def creased_normals(
    vertices: Float32[np.ndarray, "vertices 3"], faces: Int32[np.ndarray, "faces 3"]
) -> Float32[np.ndarray, "faces 3 3"]:
    """Normals of corners from the triangles alone: smooth over flat edges, sharp over steep ones.

    A corner gets the area-weighted mean of all faces that meet there, unless that differs by more
    than 40° from its own face. Zero for triangles without area.
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
