"""Outlines cut into triangles by their ears, as ``triangulate`` of ``RecastMesh.cpp``."""

import numpy as np
from jaxtyping import Bool

from hypernav.worlds.navmesh.recast.polygons.contours import Corners
from hypernav.worlds.navmesh.recast.polygons.lattice import (
    crosses,
    is_in_closed_cone,
    is_in_cone,
    is_same,
    squared_gap,
    touches,
)


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
