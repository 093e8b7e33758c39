"""Polygons that fill outlines: Delaunay's triangles, joined where they stay convex."""

import numpy as np
from jaxtyping import Bool, Float64, Int64
from scipy.spatial import Delaunay

from hypernav.core.errors import NavmeshError
from hypernav.worlds.navmesh.files.file_format import VERTICES_PER_POLYGON

_ROUNDS = 40
_LEAST_AREA_M2 = 1e-9


def fill(
    points: Float64[np.ndarray, "n k"], sides: Int64[np.ndarray, "s 2"]
) -> tuple[Float64[np.ndarray, "m k"], Int64[np.ndarray, "t 3"]]:
    """Triangles that fill closed lines.

    A side that is missing in the Delaunay triangulation is halved until all parts are in it.

    Args:
        points: Points; the first two columns are x and y, the others are interpolated.
        sides: Sides of the lines as numbers of points; the inside is on their left.

    Returns:
        All points, including added ones, and the triangles, counter-clockwise.

    Raises:
        NavmeshError: Two sides cross.
    """
    for _ in range(_ROUNDS):
        mesh = Delaunay(points[:, :2])
        edges = np.sort(np.concatenate([mesh.simplices[:, [i, (i + 1) % 3]] for i in range(3)]))
        known = edges[:, 0] * len(points) + edges[:, 1]
        ordered = np.sort(sides, axis=1)
        missing = ~np.isin(ordered[:, 0] * len(points) + ordered[:, 1], known)
        if not missing.any():
            return points, _inside(mesh, points, sides)
        a, b = sides[missing].T
        new = np.arange(len(points), len(points) + len(a))
        points = np.concatenate([points, (points[a] + points[b]) / 2.0])
        halves = np.concatenate([np.stack([a, new], axis=1), np.stack([new, b], axis=1)])
        sides = np.concatenate([sides[~missing], halves])
    raise NavmeshError("the outlines of the walkable surface cross each other; choose other cells")


def _inside(
    mesh: Delaunay, points: Float64[np.ndarray, "n k"], sides: Int64[np.ndarray, "s 2"]
) -> Int64[np.ndarray, "t 3"]:
    """The triangles on the left of the sides, and all that are reachable without crossing one."""
    triangles = mesh.simplices.astype(np.int64)
    a, b, c = (points[triangles[:, i], :2] for i in range(3))
    areas = ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2.0
    triangles = np.where(areas[:, None] < 0.0, triangles[:, ::-1], triangles)
    # Points on a line may make triangles without area at the border.
    triangles = triangles[np.abs(areas) > _LEAST_AREA_M2]
    number = len(points)
    along = {a * number + b for a, b in sides.tolist()}
    owner = {
        corners[i] * number + corners[(i + 1) % 3]: triangle
        for triangle, corners in enumerate(triangles.tolist())
        for i in range(3)
    }
    inside: Bool[np.ndarray, " t"] = np.zeros(len(triangles), dtype=bool)
    waiting = [owner[side] for side in along if side in owner]
    while waiting:
        triangle = waiting.pop()
        if inside[triangle]:
            continue
        inside[triangle] = True
        corners = triangles[triangle].tolist()
        for i in range(3):
            p, q = corners[i], corners[(i + 1) % 3]
            other = owner.get(q * number + p)
            if p * number + q not in along and other is not None:
                waiting.append(other)
    return triangles[inside]


def join(
    points: Float64[np.ndarray, "n k"], triangles: Int64[np.ndarray, "t 3"]
) -> list[list[int]]:
    """Join triangles over their longest common sides to convex polygons, as Recast does."""
    polygons: dict[int, list[int]] = dict(enumerate(triangles.tolist()))
    owner = {
        (corners[i], corners[(i + 1) % 3]): number
        for number, corners in polygons.items()
        for i in range(3)
    }
    plane = points[:, :2]
    inner = [(a, b) for a, b in owner if a < b and (b, a) in owner]
    inner.sort(key=lambda side: -float(((plane[side[0]] - plane[side[1]]) ** 2).sum()))
    for a, b in inner:
        left, right = owner[a, b], owner[b, a]
        joined = _joined(polygons[left], polygons[right], a, b)
        if not _is_convex(plane, joined):
            continue
        del polygons[right]
        polygons[left] = joined
        for i, corner in enumerate(joined):
            owner[corner, joined[(i + 1) % len(joined)]] = left
    return list(polygons.values())


def _joined(left: list[int], right: list[int], a: int, b: int) -> list[int]:
    """Two polygons merged at the side from a to b of the left one."""
    i, j = left.index(b), right.index(a)
    return [*left[i:], *left[:i], *right[j + 1 :], *right[:j]][: len(left) + len(right) - 2]


def _is_convex(plane: Float64[np.ndarray, "n 2"], corners: list[int]) -> bool:
    """Whether corners make a convex polygon with at most as many corners as a tile allows."""
    if len(corners) > VERTICES_PER_POLYGON or len(set(corners)) < len(corners):
        return False
    around = plane[corners]
    sides = np.roll(around, -1, axis=0) - around
    after = np.roll(sides, -1, axis=0)
    return bool((sides[:, 0] * after[:, 1] - sides[:, 1] * after[:, 0] >= 0.0).all())
