"""Convex polygons of a region's outlines (numba kernels), as ``RecastMesh.cpp``."""

import numpy as np
from numba import njit

from hypernav.worlds.navmesh.recast.lattice_kernels import area2, squared_gap
from hypernav.worlds.navmesh.recast.triangulation_kernels import triangulate

MOST_CORNERS = 6
"""Largest number of corners of a polygon."""
_NONE = -1
_BUCKETS = 1 << 12
_SAME_HEIGHT = 2
"""Largest difference in height, voxels, of two corners at one position that are merged."""


@njit(cache=True, nogil=True)
def convex_polygons(corners, begin, length, owner):
    """Cut all contours into convex polygons with common corners.

    Args:
        corners: Corners of all contours, see `contour_kernels`.
        begin: First corner of every contour.
        length: Number of corners of every contour.
        owner: Region of every contour.

    Returns:
        Vertices (column x, height in voxels, column z), and of every polygon its vertices padded
        with -1, and its region.
    """
    most = length.sum()
    vertices = np.empty((most, 3), dtype=np.int64)
    polygons = np.full((most, MOST_CORNERS), _NONE, dtype=np.int64)
    regions = np.zeros(most, dtype=np.int64)
    first, following = np.full(_BUCKETS, _NONE), np.full(most, _NONE)
    known, count = 0, 0
    for contour in range(len(owner)):
        if length[contour] < 3:
            continue
        outline = corners[begin[contour] : begin[contour] + length[contour]]
        triangles = triangulate(outline)
        numbers = np.empty(len(outline), dtype=np.int64)
        for k in range(len(outline)):
            numbers[k] = _vertex(outline[k], vertices, known, first, following)
            known = max(known, numbers[k] + 1)
        joined = _joined(numbers, triangles, vertices)
        polygons[count : count + len(joined)] = joined
        regions[count : count + len(joined)] = owner[contour]
        count += len(joined)
    return vertices[:known].copy(), polygons[:count].copy(), regions[:count].copy()


@njit(cache=True, nogil=True)
def neighbours(polygons, vertex_count):
    """Polygon behind every side, -1 where there is none."""
    sides = polygons.size
    first, following = np.full(vertex_count, _NONE), np.full(sides, _NONE)
    other_end, owner = np.empty(sides, dtype=np.int64), np.empty(sides, dtype=np.int64)
    taken = np.zeros(sides, dtype=np.bool_)
    beyond = np.full(polygons.shape, _NONE)
    count = _corner_counts(polygons)
    for i in range(len(polygons)):
        for j in range(count[i]):
            a, b = polygons[i, j], polygons[i, (j + 1) % count[i]]
            if a < b:
                side = i * MOST_CORNERS + j
                other_end[side], owner[side] = b, i
                following[side], first[a] = first[a], side
    for i in range(len(polygons)):
        for j in range(count[i]):
            a, b = polygons[i, j], polygons[i, (j + 1) % count[i]]
            side = first[b] if a > b else _NONE
            while side != _NONE:
                if other_end[side] == a and not taken[side]:
                    # Recast counts a side of a polygon with itself as open.
                    taken[side] = owner[side] != i
                    if taken[side]:
                        beyond[i, j] = owner[side]
                        beyond[owner[side], side % MOST_CORNERS] = i
                    break
                side = following[side]
    return beyond


@njit(cache=True, nogil=True)
def _corner_counts(polygons):
    count = np.zeros(len(polygons), dtype=np.int64)
    for i in range(len(polygons)):
        while count[i] < MOST_CORNERS and polygons[i, count[i]] != _NONE:
            count[i] += 1
    return count


@njit(cache=True, nogil=True)
def _vertex(corner, vertices, known, first, following):
    """Number of the vertex at a corner; a new one if none is there."""
    bucket = (corner[0] * 521 + corner[2]) % _BUCKETS
    i = first[bucket]
    while i != _NONE:
        if (
            vertices[i, 0] == corner[0]
            and vertices[i, 2] == corner[2]
            and abs(vertices[i, 1] - corner[1]) <= _SAME_HEIGHT
        ):
            return i
        i = following[i]
    vertices[known] = corner[:3]
    following[known], first[bucket] = first[bucket], known
    return known


@njit(cache=True, nogil=True)
def _joined(numbers, triangles, vertices):
    """Polygons of a contour's triangles, joined over the longest sides first while convex."""
    polygons = np.full((len(triangles) + 1, MOST_CORNERS), _NONE)
    count = 0
    for k in range(len(triangles)):
        for j in range(3):
            polygons[count, j] = numbers[triangles[k, j]]
        count += 1
    values = np.full((count, count), -1)
    for a in range(count):
        for b in range(a + 1, count):
            values[a, b] = _common_side(polygons[a], polygons[b], vertices)[0]
    while True:
        best, one, other = 0, _NONE, _NONE
        for a in range(count - 1):
            for b in range(a + 1, count):
                if values[a, b] > best:
                    best, one, other = values[a, b], a, b
        if one == _NONE:
            return polygons[:count]
        _, side_one, side_other = _common_side(polygons[one], polygons[other], vertices)
        _join(polygons, one, other, side_one, side_other)
        count -= 1
        polygons[other] = polygons[count]
        polygons[count] = _NONE
        for changed in (one, other):
            for k in range(count):
                a, b = min(changed, k), max(changed, k)
                if a < b < count:
                    values[a, b] = _common_side(polygons[a], polygons[b], vertices)[0]


@njit(cache=True, nogil=True)
def _size(polygon):
    size = 0
    while size < MOST_CORNERS and polygon[size] != _NONE:
        size += 1
    return size


@njit(cache=True, nogil=True)
def _common_side(one, other, vertices):
    """The squared length of the side over which two polygons can be joined, and its numbers.

    The length is -1 if there is none, or if the merged polygon would have too many corners or would
    not be convex.
    """
    n, m = _size(one), _size(other)
    if n + m - 2 > MOST_CORNERS:
        return -1, _NONE, _NONE
    i, j = _NONE, _NONE
    for a in range(n):
        for b in range(m):
            p, q = one[a], one[(a + 1) % n]
            r, s = other[b], other[(b + 1) % m]
            if (p == r and q == s) or (p == s and q == r):
                i, j = a, b
                break
    if i == _NONE:
        return -1, _NONE, _NONE
    convex = _is_convex(vertices, one[(i - 1) % n], one[i], other[(j + 2) % m]) and _is_convex(
        vertices, other[(j - 1) % m], other[j], one[(i + 2) % n]
    )
    if not convex:
        return -1, _NONE, _NONE
    return squared_gap(vertices[one[i]], vertices[one[(i + 1) % n]]), i, j


@njit(cache=True, nogil=True)
def _is_convex(vertices, a, b, c):
    return area2(vertices[a], vertices[b], vertices[c]) < 0


@njit(cache=True, nogil=True)
def _join(polygons, one, other, side_one, side_other):
    """Write the polygon of two into the first."""
    n, m = _size(polygons[one]), _size(polygons[other])
    corners = np.full(MOST_CORNERS, _NONE)
    for k in range(n - 1):
        corners[k] = polygons[one, (side_one + 1 + k) % n]
    for k in range(m - 1):
        corners[n - 1 + k] = polygons[other, (side_other + 1 + k) % m]
    polygons[one] = corners
