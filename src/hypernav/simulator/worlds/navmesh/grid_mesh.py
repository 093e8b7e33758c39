"""The walkable surface of a storey as the polygons of a navigation mesh.

The outlines of the standable cells are straightened and filled with polygons: Delaunay's triangles,
joined where they stay convex.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64
from scipy.spatial import Delaunay

from hypernav.core.errors import NavmeshError
from hypernav.core.geometry.transforms import distances_to_segment
from hypernav.simulator.worlds.navmesh.file_format import VERTICES_PER_POLYGON
from hypernav.simulator.worlds.navmesh.navmesh_writer import PolygonMesh
from hypernav.simulator.worlds.surface.walkable import WalkableGrid

_TOWARDS = ((0, 1), (1, 0), (0, -1), (-1, 0))
"""Steps in rows and columns along the sides of a cell, counter-clockwise: each turns left."""
_ROUNDS = 40
_LEAST_AREA_M2 = 1e-9
_TOLERANCE = 0.34
"""Cells: 1.7 cm. Outlines are at least 0.7 cells apart, so that they stay apart."""


@dataclass(frozen=True, eq=False)
class Outline:
    """A closed line around standable cells, or around a hole in them.

    Attributes:
        points: Corners in cells (x, y), with the standable cells on the left.
        cells: Standable cell ``[row, column]`` at every corner.
    """

    points: Float64[np.ndarray, "n 2"]
    cells: Int64[np.ndarray, "n 2"]


def outlines(standable: Bool[np.ndarray, "rows columns"], tolerance: float) -> list[Outline]:
    """The outlines of all standable cells.

    They run through the middles of the cells' sides, so that the staircase of a slanting line is
    nearly straight. Cells that only touch at a corner have separate outlines.

    Args:
        standable: The cells.
        tolerance: Largest distance between the outline and an omitted corner, cells.
    """
    return [_straightened(line, tolerance) for line in _traced(np.pad(standable, 1))]


def _traced(free: Bool[np.ndarray, "rows columns"]) -> list[Outline]:
    """Exact outlines; the grid has a border of one blocked cell, which isn't counted."""
    # A side is the cell and its direction of travel, with the cell on the left.
    sides: dict[tuple[int, int, int], None] = {}
    beyond = {0: (-1, 0), 1: (0, 1), 2: (1, 0), 3: (0, -1)}
    for direction, (down, right) in beyond.items():
        blocked = free & ~np.roll(free, (-down, -right), axis=(0, 1))
        for row, column in np.argwhere(blocked).tolist():
            sides[(row, column, direction)] = None
    lines = []
    while sides:
        side = next(iter(sides))
        points, cells = [], []
        while side in sides:
            del sides[side]
            row, column, direction = side
            down, right = beyond[direction]
            points.append((column - 0.5 + 0.5 * right, row - 0.5 + 0.5 * down))
            cells.append((row - 1, column - 1))
            side = _next(free, row, column, direction)
        lines.append(Outline(np.array(points), np.array(cells)))
    return lines


def _next(
    free: Bool[np.ndarray, "rows columns"], row: int, column: int, direction: int
) -> tuple[int, int, int]:
    """The next side: of this cell, of the one ahead, or of the one diagonally ahead."""
    ahead = row + _TOWARDS[direction][0], column + _TOWARDS[direction][1]
    if not free[ahead]:
        return row, column, (direction + 1) % 4
    right = _TOWARDS[(direction - 1) % 4]
    across = ahead[0] + right[0], ahead[1] + right[1]
    if free[across]:
        return (*across, (direction - 1) % 4)
    return (*ahead, direction)


def _straightened(line: Outline, tolerance: float) -> Outline:
    """Simplify by Douglas and Peucker's algorithm, between two corners that are far apart."""
    points = line.points
    far = int(np.argmax(((points - points[0]) ** 2).sum(axis=1)))
    kept = {0, far}
    waiting = [(0, far), (far, len(points))]
    closed = np.concatenate([points, points[:1]])
    while waiting:
        first, last = waiting.pop()
        if last - first < 2:
            continue
        gaps = distances_to_segment(closed[first + 1 : last], closed[first], closed[last])
        worst = int(np.argmax(gaps))
        if gaps[worst] > tolerance:
            middle = first + 1 + worst
            kept.add(middle)
            waiting += [(first, middle), (middle, last)]
    order = sorted(kept)
    if len(order) < 3:  # A thin outline must keep an area.
        order = list(range(len(points)))
    return Outline(points[order], line.cells[order])


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


def mesh_from_grid(walkable: WalkableGrid) -> PolygonMesh:
    """Polygons over all standable cells, equal in area.

    Detour's search runs over the middles of sides, for which large polygons are better than small
    ones, so polygons are cut only as the outlines require. Heights are those of the floor at the
    outlines.

    Raises:
        NavmeshError: There are more polygons than a file has room for, or nothing to stand on.
    """
    lines = outlines(walkable.standable, _TOLERANCE)
    if not lines:
        raise NavmeshError("the walkable surface has no standable cell to write")
    counts = [len(line.points) for line in lines]
    first = np.cumsum([0, *counts])
    sides = np.concatenate(
        [
            start + np.stack([np.arange(count), np.roll(np.arange(count), -1)], axis=1)
            for start, count in zip(first, counts, strict=False)
        ]
    )
    points = np.concatenate([line.points for line in lines])
    cells = np.concatenate([line.cells for line in lines])
    heights = walkable.heights[cells[:, 0], cells[:, 1]].astype(np.float64)
    plane = points * walkable.cell_m + np.array(walkable.origin)
    vertices, triangles = fill(np.column_stack([plane, heights]), sides)
    return PolygonMesh.of(vertices, join(vertices, triangles))
