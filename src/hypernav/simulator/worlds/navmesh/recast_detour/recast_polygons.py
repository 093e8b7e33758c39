"""Convex polygons of regions' outlines, which are first cut into triangles by their ears.

As ``RecastMesh.cpp``.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Int64

from hypernav.simulator.worlds.navmesh.recast_detour.recast_contours import (
    Contour,
    Corners,
    crosses,
    is_in_closed_cone,
    is_in_cone,
    is_same,
    squared_gap,
    touches,
)

MOST_CORNERS = 6
"""Corners that a polygon may have."""
_NONE = -1
_SAME_HEIGHT = 2
"""Voxels by which two corners at the same place may differ to be one."""
Vertex = tuple[int, int, int]


def triangulate(corners: Corners) -> list[tuple[int, int, int]]:
    """Cut an outline into triangles, the ear with the shortest cut first.

    Returns:
        Corners of every triangle; less triangles where the outline runs over itself.
    """
    numbers = list(range(len(corners)))
    left = corners
    count = len(left)
    # Whether each corner can be cut off.
    ears = np.array([_is_diagonal(left, k - 1, (k + 1) % count) for k in range(count)])
    triangles = []
    while count > 3:
        best = _shortest_ear(left, ears)
        if best is None:
            best = _loose_ear(left)
        if best is None:
            return triangles
        ear, after = (best + 1) % count, (best + 2) % count
        triangles.append((numbers[best], numbers[ear], numbers[after]))
        del numbers[ear]
        left, ears = np.delete(left, ear, axis=0), np.delete(ears, ear)
        count -= 1
        after = ear % count
        before = (after - 1) % count
        ears[before] = _is_diagonal(left, before - 1, after)
        ears[after] = _is_diagonal(left, before, (after + 1) % count)
    return [*triangles, (numbers[0], numbers[1], numbers[2])]


def _shortest_ear(corners: Corners, ears: Bool[np.ndarray, " n"]) -> int | None:
    """The corner before the ear."""
    before = np.flatnonzero(np.roll(ears, -1))
    if len(before) == 0:
        return None
    gaps = squared_gap(corners[before], corners[(before + 2) % len(corners)])
    return int(before[gaps.argmin()])


def _loose_ear(corners: Corners) -> int | None:
    """An ear where sides may overlap, by the length to the corner behind the cut, as Recast has it.

    This happens where an outline runs over itself.
    """
    count = len(corners)
    loose = [i for i in range(count) if _is_diagonal(corners, i, (i + 2) % count, loose=True)]
    behind = [(i + 3) % count for i in loose]
    return loose[squared_gap(corners[loose], corners[behind]).argmin()] if loose else None


def _is_diagonal(corners: Corners, i: int, j: int, loose: bool = False) -> bool:
    """Whether the line between two corners is within the outline; if loose, it may touch sides."""
    is_within, meets = (is_in_closed_cone, crosses) if loose else (is_in_cone, touches)
    a, b = corners[i], corners[j]
    if not is_within(corners[i - 1], a, corners[(i + 1) % len(corners)], b):
        return False
    # Sides that begin or end where the line does may be met.
    at_end = is_same(corners, a) | is_same(corners, b)
    counts = ~(at_end | np.roll(at_end, -1))
    after = np.roll(corners, -1, axis=0)[counts]
    return not meets(a, b, corners[counts], after).any()


class Polygons(NamedTuple):
    """Polygons as Recast makes them.

    Attributes:
        vertices: Column x, height in voxels, column z.
        corners: Vertices of every polygon, padded with -1.
        regions: Region of every polygon.
    """

    vertices: Int64[np.ndarray, "v 3"]
    corners: Int64[np.ndarray, "p 6"]
    regions: Int64[np.ndarray, " p"]


class _Side(NamedTuple):
    """A side over which two polygons can be joined.

    Attributes:
        squared_length: Its length, squared.
        of_one: Its number in the one polygon.
        of_other: Its number in the other.
    """

    squared_length: int
    of_one: int
    of_other: int


def convex_polygons(contours: list[Contour]) -> Polygons:
    """Cut all contours into convex polygons with common corners."""
    vertices: list[Vertex] = []
    at: dict[tuple[int, int], list[int]] = {}
    polygons: list[list[int]] = []
    regions: list[int] = []
    for corners, region in contours:
        if len(corners) < 3:
            continue
        numbers = [_vertex((x, y, z), vertices, at) for x, y, z, _ in corners.tolist()]
        triangles = [[numbers[k] for k in triangle] for triangle in triangulate(corners)]
        joined = _joined(triangles, vertices)
        polygons += joined
        regions += [region] * len(joined)
    padded = [polygon + [_NONE] * (MOST_CORNERS - len(polygon)) for polygon in polygons]
    return Polygons(
        np.array(vertices, dtype=np.int64).reshape(-1, 3),
        np.array(padded, dtype=np.int64).reshape(-1, MOST_CORNERS),
        np.array(regions, dtype=np.int64),
    )


def neighbours(polygons: Int64[np.ndarray, "p 6"]) -> Int64[np.ndarray, "p 6"]:
    """Polygon behind every side, -1 where there is none."""
    beyond = np.full(polygons.shape, _NONE)
    sides = [
        (i, j, polygon[j], polygon[(j + 1) % len(polygon)])
        for i, polygon in enumerate([p[p != _NONE].tolist() for p in polygons])
        for j in range(len(polygon))
    ]
    waiting: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for i, j, a, b in sides:
        if a < b:
            waiting.setdefault((a, b), []).append((i, j))
    for i, j, a, b in sides:
        others = waiting.get((b, a)) if a > b else None
        # Recast counts a side of a polygon with itself as open.
        if others and others[-1][0] != i:
            other, side = others.pop()
            beyond[i, j], beyond[other, side] = other, i
    return beyond


def _vertex(corner: Vertex, vertices: list[Vertex], at: dict[tuple[int, int], list[int]]) -> int:
    """Number of the vertex at a corner; a new one if none is there."""
    x, y, z = corner
    here = at.setdefault((x, z), [])
    for number in reversed(here):
        if abs(vertices[number][1] - y) <= _SAME_HEIGHT:
            return number
    here.append(len(vertices))
    vertices.append(corner)
    return here[-1]


def _joined(polygons: list[list[int]], vertices: list[Vertex]) -> list[list[int]]:
    """Polygons of a contour's triangles, joined over the longest sides first while convex."""
    sides: dict[tuple[int, int], _Side] = {}

    def look(one: int, other: int) -> None:
        side = _common_side(polygons[one], polygons[other], vertices)
        if side is not None:
            sides[one, other] = side

    for a in range(len(polygons)):
        for b in range(a + 1, len(polygons)):
            look(a, b)
    while sides:
        one, other = min(sides, key=lambda pair: (-sides[pair].squared_length, pair))
        side = sides[one, other]
        polygons[one] = _without(polygons[one], side.of_one) + _without(
            polygons[other], side.of_other
        )
        last = polygons.pop()
        if other < len(polygons):
            polygons[other] = last
        changed = {one, other, len(polygons)}
        sides = {pair: side for pair, side in sides.items() if changed.isdisjoint(pair)}
        for k in range(len(polygons)):
            for number in {one, other} - {k, len(polygons)}:
                look(min(k, number), max(k, number))
    return polygons


def _without(polygon: list[int], side: int) -> list[int]:
    """The corners of a polygon from behind a side up to it, without the last."""
    return [*polygon[side + 1 :], *polygon[:side]]


def _common_side(one: list[int], other: list[int], vertices: list[Vertex]) -> _Side | None:
    """The side over which two polygons can be joined.

    There is none if the polygon had too many corners, or were not convex.
    """
    n, m = len(one), len(other)
    if n + m - 2 > MOST_CORNERS or len(set(one).intersection(other)) < 2:
        return None
    common = None
    for a in range(n):
        ends = {one[a], one[(a + 1) % n]}
        for b in range(m):
            if ends == {other[b], other[(b + 1) % m]}:
                common = a, b
                break
    if common is None:
        return None
    i, j = common
    if not (
        _is_convex(vertices, one[i - 1], one[i], other[(j + 2) % m])
        and _is_convex(vertices, other[j - 1], other[j], one[(i + 2) % n])
    ):
        return None
    (ax, _, az), (bx, _, bz) = vertices[one[i]], vertices[one[(i + 1) % n]]
    squared = (bx - ax) ** 2 + (bz - az) ** 2
    return _Side(squared, i, j) if squared > 0 else None


def _is_convex(vertices: list[Vertex], a: int, b: int, c: int) -> bool:
    (ax, _, az), (bx, _, bz), (cx, _, cz) = vertices[a], vertices[b], vertices[c]
    return (bx - ax) * (cz - az) - (cx - ax) * (bz - az) < 0
