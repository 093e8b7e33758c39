"""Interpenetration of the models of a house."""

from itertools import combinations

import numpy as np

from hypernav.simulator.houses.assembly import PlacedModel, bounding_box
from hypernav.simulator.houses.modelling.model import Mesh, Part, rotation_matrix

ALLOWED_M = 0.01
_BUILDING = ("floor", "wall", "ceiling", "facade")


def collisions(pieces: list[PlacedModel]) -> list[tuple[str, str]]:
    """Pairs of models of which one has a point more than 1 cm inside a part of the other.

    Parts are compared by their boxes first. A point is inside a part if the part's surface winds
    around it, and deep if that holds a centimetre away from it in all six directions too.
    """
    models = [p for p in pieces if not (p.structural and p.model.category in _BUILDING)]
    boxes = np.array([bounding_box(p) for p in models])
    found = []
    for i, j in combinations(range(len(models)), 2):
        if _overlap(boxes[i], boxes[j]) and (
            _penetrates(models[i], models[j]) or _penetrates(models[j], models[i])
        ):
            found.append((models[i].model.category, models[j].model.category))
    return found


def _overlap(a: np.ndarray, b: np.ndarray) -> bool:
    return bool((np.minimum(a[3:], b[3:]) - np.maximum(a[:3], b[:3]) > ALLOWED_M + 1e-4).all())


def _penetrates(piece: PlacedModel, other: PlacedModel) -> bool:
    targets = [_placed(part, other) for part in other.model.parts]
    boxes = [_box(mesh) for mesh in targets]
    for part in piece.model.parts:
        mesh = _placed(part, piece)
        own = _box(mesh)
        for target, box in zip(targets, boxes, strict=True):
            if _overlap(own, box) and _deepest(_points_on(mesh, box), target):
                return True
    return False


def _placed(part: Part, piece: PlacedModel) -> Mesh:
    r = rotation_matrix(piece.yaw_deg)
    points = part.mesh.positions @ r.T + (piece.x, piece.y, piece.z)
    return Mesh(points, part.mesh.normals, part.mesh.uv, part.mesh.faces)


def _box(mesh: Mesh) -> np.ndarray:
    return np.concatenate([mesh.positions.min(axis=0), mesh.positions.max(axis=0)])


def _points_on(mesh: Mesh, box: np.ndarray) -> np.ndarray:
    """Points about 2 cm apart on the part of a surface that lies in a box."""
    corners = mesh.positions[mesh.faces]
    near = (corners.max(axis=1) > box[:3]).all(axis=1) & (corners.min(axis=1) < box[3:]).all(axis=1)
    points = []
    for a, b, c in corners[near]:
        longest = max(np.linalg.norm(b - a), np.linalg.norm(c - a), np.linalg.norm(c - b))
        n = int(np.clip(longest / 0.02, 1, 60))
        u, v = np.meshgrid(np.arange(n + 1) / n, np.arange(n + 1) / n)
        inside = (u + v) <= 1.0
        points.append(a + u[inside][:, None] * (b - a) + v[inside][:, None] * (c - a))
    if not points:
        return np.zeros((0, 3))
    found = np.concatenate(points)
    keep = (found > box[:3] + ALLOWED_M).all(axis=1) & (found < box[3:] - ALLOWED_M).all(axis=1)
    return found[keep][::3]


def _deepest(points: np.ndarray, mesh: Mesh) -> bool:
    if len(points) == 0:
        return False
    inside = points[_winds_around(points, mesh)]
    for axis in range(3):
        for sign in (-1.0, 1.0):
            if len(inside) == 0:
                return False
            step = np.zeros(3)
            step[axis] = sign * ALLOWED_M
            inside = inside[_winds_around(inside + step, mesh)]
    return len(inside) > 0


def _winds_around(points: np.ndarray, mesh: Mesh) -> np.ndarray:
    """Winding number above one half (van Oosterom and Strackee's solid angle)."""
    result = np.zeros(len(points))
    for start in range(0, len(points), 256):
        p = points[start : start + 256]
        a, b, c = (mesh.positions[mesh.faces[:, k]][None] - p[:, None] for k in range(3))
        la, lb, lc = (np.linalg.norm(v, axis=2) for v in (a, b, c))
        top = (a * np.cross(b, c)).sum(axis=2)
        below = la * lb * lc + (a * b).sum(2) * lc + (b * c).sum(2) * la + (c * a).sum(2) * lb
        result[start : start + 256] = np.arctan2(top, below).sum(axis=1) / (2.0 * np.pi)
    return np.abs(result) > 0.5
