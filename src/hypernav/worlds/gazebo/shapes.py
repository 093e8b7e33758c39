"""The simple shapes of Gazebo's format: boxes, planes, cylinders, spheres and what is like them."""

import xml.etree.ElementTree as ElementTree

import numpy as np
import trimesh
from jaxtyping import Float64

from hypernav.worlds.collada.triangles import numbers_of
from hypernav.worlds.scenes.scene_assembly import MeshPart

_SIDES = 24
_ENDLESS_M = 100.0
_SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
_BOX_SIDES = ((0, 1), (1, 2), (2, 0))


def shape_of(geometry: ElementTree.Element) -> MeshPart | None:
    """The triangles of a simple shape; None if there is none in this element.

    Args:
        geometry: An element ``geometry``.

    Raises:
        ValueError: A size is no number.
    """
    for kind in geometry:
        if kind.tag == "box":
            return _box(_sizes(kind, "size", (1.0, 1.0, 1.0)))
        if kind.tag == "plane":
            return _plane(kind)
        if kind.tag in ("cylinder", "cone", "capsule"):
            (radius,) = _sizes(kind, "radius", (1.0,))
            (length,) = _sizes(kind, "length", (1.0,))
            return _round(kind.tag, radius, length)
        if kind.tag == "sphere":
            (radius,) = _sizes(kind, "radius", (1.0,))
            return _ball(np.full(3, radius))
        if kind.tag == "ellipsoid":
            return _ball(_sizes(kind, "radii", (1.0, 1.0, 1.0)))
    return None


def endless_ground() -> MeshPart:
    """Gazebo's own model ``ground_plane``."""
    return _quads([_rectangle(2, 0, 1, np.array([_ENDLESS_M, _ENDLESS_M, 0.0]), 0.0)], _ENDLESS_M)


def _sizes(
    kind: ElementTree.Element, name: str, default: tuple[float, ...]
) -> Float64[np.ndarray, "n"]:
    values = numbers_of(kind.findtext(name))
    if not len(values):
        return np.array(default)
    if len(values) != len(default):
        raise ValueError(f"{name} has {len(values)} numbers, expected {len(default)}")
    return values


def _box(size: Float64[np.ndarray, "3"]) -> MeshPart:
    sides = []
    for u, v in _BOX_SIDES:
        w = 3 - u - v
        front = _rectangle(w, u, v, size, size[w] / 2.0)
        back = _rectangle(w, u, v, size, -size[w] / 2.0)[[3, 2, 1, 0]]
        sides += [front, back]
    return _quads(sides, 1.0)


def _rectangle(
    w: int, u: int, v: int, size: Float64[np.ndarray, "3"], at: float
) -> Float64[np.ndarray, "4 3"]:
    """Corners of a rectangle along axes `u` and `v`, at a place along axis `w`."""
    corners = np.zeros((4, 3))
    corners[:, u] = (_SQUARE[:, 0] - 0.5) * size[u]
    corners[:, v] = (_SQUARE[:, 1] - 0.5) * size[v]
    corners[:, w] = at
    return corners


def _plane(kind: ElementTree.Element) -> MeshPart:
    width, length = _sizes(kind, "size", (1.0, 1.0))
    normal = _sizes(kind, "normal", (0.0, 0.0, 1.0))
    flat = _quads([_rectangle(2, 0, 1, np.array([width, length, 0.0]), 0.0)], max(width, length))
    turn = np.asarray(trimesh.geometry.align_vectors((0.0, 0.0, 1.0), normal))[:3, :3]
    if abs(normal[0]) + abs(normal[1]) < 1e-9 and normal[2] > 0.0:
        return flat
    return _part(flat.vertices @ turn.T, flat.faces, flat.uv)


def _quads(sides: list[Float64[np.ndarray, "4 3"]], repeats: float) -> MeshPart:
    starts = 4 * np.arange(len(sides))[:, None, None]
    halves = np.array([[0, 1, 2], [0, 2, 3]])
    uv = np.tile(_SQUARE[halves] * repeats, (len(sides), 1, 1))
    return _part(np.concatenate(sides), (starts + halves).reshape(-1, 3), uv)


def _round(kind: str, radius: float, length: float) -> MeshPart:
    if kind == "cylinder":
        mesh = trimesh.creation.cylinder(radius, length, sections=_SIDES)
    elif kind == "cone":
        mesh = trimesh.creation.cone(radius, length, sections=_SIDES)
        mesh.apply_translation((0.0, 0.0, -length / 2.0))
    else:
        mesh = trimesh.creation.capsule(length, radius, count=[_SIDES, _SIDES])
        mesh.apply_translation((0.0, 0.0, -length / 2.0 - min(mesh.bounds[0][2] + radius, 0.0)))
    return _part(mesh.vertices, mesh.faces, None)


def _ball(radii: Float64[np.ndarray, "3"]) -> MeshPart:
    mesh = trimesh.creation.icosphere(subdivisions=2)
    return _part(mesh.vertices * radii, mesh.faces, None)


def _part(vertices: np.ndarray, faces: np.ndarray, uv: np.ndarray | None) -> MeshPart:
    return MeshPart(
        "",
        "",
        np.ascontiguousarray(vertices, dtype=np.float32),
        np.ascontiguousarray(faces, dtype=np.int32),
        0,
        None if uv is None else np.asarray(uv, dtype=np.float32),
    )
