"""Triangulates outlines by ear clipping (numba kernels), as ``triangulate`` of ``RecastMesh``.

Corners are rows as in `contour_kernels`.
"""

import numpy as np
from numba import njit

from hypernav.worlds.navmesh.recast.lattice_kernels import (
    crosses,
    is_in_closed_cone,
    is_in_cone,
    is_same,
    squared_gap,
    touches,
)


@njit(cache=True, nogil=True)
def triangulate(corners):
    """Cut an outline into triangles, the ear with the shortest cut first.

    Returns:
        Corners of every triangle; fewer triangles if the outline overlaps itself.
    """
    left = len(corners)
    numbers = np.arange(left)
    ears = np.zeros(left, dtype=np.bool_)
    triangles = np.empty((max(left - 2, 0), 3), dtype=np.int64)
    count = 0
    for i in range(left):
        ears[(i + 1) % left] = _is_diagonal(corners, numbers, left, i, (i + 2) % left)
    while left > 3:
        best = _shortest_ear(corners, numbers, ears, left)
        if best < 0:
            best = _loose_ear(corners, numbers, left)
        if best < 0:
            return triangles[:count]
        ear, after = (best + 1) % left, (best + 2) % left
        triangles[count] = (numbers[best], numbers[ear], numbers[after])
        count += 1
        left -= 1
        for k in range(ear, left):
            numbers[k], ears[k] = numbers[k + 1], ears[k + 1]
        after = ear % left
        before = (after - 1) % left
        ears[before] = _is_diagonal(corners, numbers, left, (before - 1) % left, after)
        ears[after] = _is_diagonal(corners, numbers, left, before, (after + 1) % left)
    triangles[count] = numbers[:3]
    return triangles[: count + 1]


@njit(cache=True, nogil=True)
def _shortest_ear(corners, numbers, ears, left):
    best, shortest = -1, -1
    for i in range(left):
        if ears[(i + 1) % left]:
            gap = squared_gap(corners[numbers[i]], corners[numbers[(i + 2) % left]])
            if shortest < 0 or gap < shortest:
                best, shortest = i, gap
    return best


@njit(cache=True, nogil=True)
def _loose_ear(corners, numbers, left):
    """An ear whose sides may overlap, by the length to the corner behind the cut, as in Recast.

    Needed where an outline overlaps itself.
    """
    best, shortest = -1, -1
    for i in range(left):
        if _is_loose_diagonal(corners, numbers, left, i, (i + 2) % left):
            gap = squared_gap(corners[numbers[i]], corners[numbers[(i + 3) % left]])
            if shortest < 0 or gap < shortest:
                best, shortest = i, gap
    return best


@njit(cache=True, nogil=True)
def _is_diagonal(corners, numbers, left, i, j):
    """Whether the line between two corners lies within the outline."""
    a, b = corners[numbers[i]], corners[numbers[j]]
    before, after = corners[numbers[(i - 1) % left]], corners[numbers[(i + 1) % left]]
    if not is_in_cone(before, a, after, b):
        return False
    for k in range(left):
        p, q = corners[numbers[k]], corners[numbers[(k + 1) % left]]
        if not _is_beside(left, i, j, k, a, b, p, q) and touches(a, b, p, q):
            return False
    return True


@njit(cache=True, nogil=True)
def _is_loose_diagonal(corners, numbers, left, i, j):
    """The same, but the line may touch sides."""
    a, b = corners[numbers[i]], corners[numbers[j]]
    before, after = corners[numbers[(i - 1) % left]], corners[numbers[(i + 1) % left]]
    if not is_in_closed_cone(before, a, after, b):
        return False
    for k in range(left):
        p, q = corners[numbers[k]], corners[numbers[(k + 1) % left]]
        if not _is_beside(left, i, j, k, a, b, p, q) and crosses(a, b, p, q):
            return False
    return True


@njit(cache=True, nogil=True)
def _is_beside(left, i, j, k, a, b, p, q):
    """Whether the k-th side, from p to q, shares an end with a line, so that it may touch it."""
    after = (k + 1) % left
    if k in (i, j) or after in (i, j):
        return True
    return is_same(a, p) or is_same(b, p) or is_same(a, q) or is_same(b, q)
