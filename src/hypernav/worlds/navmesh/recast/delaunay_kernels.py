"""Triangulations of detail vertices (numba kernels), as ``RecastMeshDetail.cpp``.

Vertices are rows of x, y, z in metres, single precision; distances are in the plane of x and z.
"""

import math

import numpy as np
from numba import njit

_OPEN = -1
"""Marks a face of an edge that is not known yet."""
_HULL = -2
_NONE = -1
_LEAST_CROSS = np.float32(1e-5)
_LEAST_TWICE_AREA = np.float32(1e-6)
_TOLERANCE = np.float32(0.001)
_ZERO, _ONE, _TWO = np.float32(0.0), np.float32(1.0), np.float32(2.0)
_FARTHEST = np.float32(np.finfo(np.float32).max)


@njit(cache=True, nogil=True)
def distance(a, b):
    """Distance in the plane."""
    dx, dz = b[0] - a[0], b[2] - a[2]
    return math.sqrt(dx * dx + dz * dz)


@njit(cache=True, nogil=True)
def triangles_of_hull(vertices, hull, corners):
    """Triangles of a convex hull without inner vertices.

    Args:
        vertices: All vertices.
        hull: Numbers of those on the hull, in order.
        corners: Number of the polygon's own corners, which come first among the vertices.
    """
    count = len(hull)
    start, left, right = 0, 1, count - 1
    shortest = _FARTHEST
    for i in range(count):
        if hull[i] >= corners:
            continue
        a, b = vertices[hull[i - 1]], vertices[hull[i]]
        c = vertices[hull[(i + 1) % count]]
        perimeter = distance(a, b) + distance(b, c) + distance(c, a)
        if perimeter < shortest:
            start, left, right = i, (i + 1) % count, (i - 1) % count
            shortest = perimeter
    triangles = np.empty((count, 3), dtype=np.int64)
    triangles[0] = (hull[start], hull[left], hull[right])
    used = 1
    while (left + 1) % count != right:
        next_left, next_right = (left + 1) % count, (right - 1) % count
        a, b = vertices[hull[left]], vertices[hull[next_left]]
        c, d = vertices[hull[right]], vertices[hull[next_right]]
        if distance(a, b) + distance(b, c) < distance(c, d) + distance(a, d):
            triangles[used] = (hull[left], hull[next_left], hull[right])
            left = next_left
        else:
            triangles[used] = (hull[left], hull[next_right], hull[right])
            right = next_right
        used += 1
    return triangles[:used]


@njit(cache=True, nogil=True)
def delaunay(vertices, hull):
    """Delaunay triangles of vertices within a hull."""
    # Rows: both ends, face to the left and face to the right.
    edges = np.full((len(vertices) * 10, 4), _OPEN)
    count, faces = 0, 0
    for k in range(len(hull)):
        count = _add(edges, count, hull[k - 1], hull[k], _HULL)
    edge = 0
    while edge < count:
        for side in (2, 3):
            if edges[edge, side] == _OPEN:
                count, faces = _complete(vertices, edges, count, faces, edge)
        edge += 1
    return _faces(edges[:count], faces)


@njit(cache=True, nogil=True)
def _cross(a, b, c):
    return (b[0] - a[0]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[0] - a[0])


@njit(cache=True, nogil=True)
def _find(edges, count, a, b):
    for k in range(count):
        if (edges[k, 0] == a and edges[k, 1] == b) or (edges[k, 0] == b and edges[k, 1] == a):
            return k
    return _NONE


@njit(cache=True, nogil=True)
def _add(edges, count, a, b, face):
    """Add an edge with the face on its left, unless it exists or there is no space."""
    if count == len(edges) or _find(edges, count, a, b) != _NONE:
        return count
    edges[count, 0], edges[count, 1], edges[count, 2], edges[count, 3] = a, b, face, _OPEN
    return count + 1


@njit(cache=True, nogil=True)
def _set_left(edges, k, a, b, face):
    """Set the face left of an edge as it runs from a to b, unless it is known."""
    if edges[k, 0] == a and edges[k, 1] == b and edges[k, 2] == _OPEN:
        edges[k, 2] = face
    elif edges[k, 1] == a and edges[k, 0] == b and edges[k, 3] == _OPEN:
        edges[k, 3] = face


@njit(cache=True, nogil=True, error_model="numpy")
def _circle(a, b, c):
    """Centre and radius of the circle through three points; no radius if they lie on a line."""
    bx, bz, cx, cz = b[0] - a[0], b[2] - a[2], c[0] - a[0], c[2] - a[2]
    cross = bx * cz - bz * cx
    if not abs(cross) > _LEAST_TWICE_AREA:
        return a[0], a[2], _ZERO
    bb, cc = bx * bx + bz * bz, cx * cx + cz * cz
    x = (bb * cz + cc * (_ZERO - bz)) / (_TWO * cross)
    z = (bb * (_ZERO - cx) + cc * bx) / (_TWO * cross)
    return x + a[0], z + a[2], math.sqrt(x * x + z * z)


@njit(cache=True, nogil=True)
def _overlaps(vertices, edges, count, a, b):
    """Whether the segment between two vertices crosses an edge."""
    for k in range(count):
        c, d = edges[k, 0], edges[k, 1]
        if c in (a, b) or d in (a, b):
            continue
        p, q, r, s = vertices[c], vertices[d], vertices[a], vertices[b]
        a1, a2 = _cross(p, q, s), _cross(p, q, r)
        if a1 * a2 < _ZERO:
            a3 = _cross(r, s, p)
            if a3 * (a3 + a2 - a1) < _ZERO:
                return True
    return False


@njit(cache=True, nogil=True)
def _complete(vertices, edges, count, faces, edge):
    """Find the triangle on the open side of an edge; returns the numbers of edges and faces."""
    if edges[edge, 2] == _OPEN:
        s, t = edges[edge, 0], edges[edge, 1]
    elif edges[edge, 3] == _OPEN:
        s, t = edges[edge, 1], edges[edge, 0]
    else:
        return count, faces
    best = _NONE
    x, z, radius = _ZERO, _ZERO, -_ONE
    for u in range(len(vertices)):
        if u in (s, t) or not _cross(vertices[s], vertices[t], vertices[u]) > _LEAST_CROSS:
            continue
        if radius >= _ZERO:
            dx, dz = vertices[u, 0] - x, vertices[u, 2] - z
            gap = math.sqrt(dx * dx + dz * dz)
            if gap > radius * (_ONE + _TOLERANCE):
                continue
            if not gap < radius * (_ONE - _TOLERANCE) and (
                _overlaps(vertices, edges, count, s, u) or _overlaps(vertices, edges, count, t, u)
            ):
                continue
        best = u
        x, z, radius = _circle(vertices[s], vertices[t], vertices[u])
    if best == _NONE:
        _set_left(edges, edge, s, t, _HULL)
        return count, faces
    _set_left(edges, edge, s, t, faces)
    for a, b in ((best, s), (t, best)):
        known = _find(edges, count, a, b)
        if known == _NONE:
            count = _add(edges, count, a, b, faces)
        else:
            _set_left(edges, known, a, b, faces)
    return count, faces + 1


@njit(cache=True, nogil=True)
def _faces(edges, faces):
    """Corners of the faces that edges belong to, without those that are not closed."""
    triangles = np.full((faces, 3), _NONE)
    for k in range(len(edges)):
        a, b = edges[k, 0], edges[k, 1]
        if edges[k, 3] >= 0:
            _take(triangles[edges[k, 3]], a, b)
        if edges[k, 2] >= 0:
            _take(triangles[edges[k, 2]], b, a)
    k = 0
    while k < faces:
        if (triangles[k] == _NONE).any():
            faces -= 1
            triangles[k] = triangles[faces]
        else:
            k += 1
    return triangles[:faces]


@njit(cache=True, nogil=True)
def _take(triangle, a, b):
    """Enter an edge from a to b into a triangle."""
    if triangle[0] == _NONE:
        triangle[0], triangle[1] = a, b
    elif triangle[0] == b:
        triangle[2] = a
    elif triangle[1] == a:
        triangle[2] = b
