"""Edges of Delaunay triangulations (numba kernels), as ``completeFacet`` of Recast.

Vertices are rows of x, y, z in metres, single precision; distances are in the plane of x and z.
An edge is a row of both ends, the face on its left and the face on its right.
"""

import math

import numpy as np
from numba import njit

OPEN = -1
"""A face that is not known yet."""
HULL = -2
"""No face: the edge belongs to the hull."""
_NONE = -1
_LEAST_CROSS = np.float32(1e-5)
_TOLERANCE = np.float32(0.001)
_ZERO, _ONE, _TWO = np.float32(0.0), np.float32(1.0), np.float32(2.0)


@njit(cache=True, nogil=True, error_model="numpy")
def complete(vertices, edges, count):
    """Find the triangles on the open sides of all edges, those of new edges among them.

    Args:
        vertices: The vertices.
        edges: Edges of the hull, and room for others; written.
        count: Number of the edges of the hull.

    Returns:
        The number of edges and of faces.
    """
    faces, edge = 0, 0
    while edge < count:
        for side in range(2, 4):
            if edges[edge, side] != OPEN:
                continue
            # The open side lies on the left, seen from s to t.
            s, t = edges[edge, side - 2], edges[edge, 3 - side]
            best = _third(vertices, edges, count, s, t)
            if best == _NONE:
                edges[edge, side] = HULL
                continue
            edges[edge, side] = faces
            for k in range(2):
                a, b = (t, best) if k else (best, s)
                count = _enter(edges, count, a, b, faces)
            faces += 1
        edge += 1
    return count, faces


@njit(cache=True, nogil=True)
def _enter(edges, count, a, b, face):
    """Set the face left of an edge, unless that is known; returns the number of edges."""
    for k in range(count):
        for side in range(2, 4):
            if edges[k, side - 2] == a and edges[k, 3 - side] == b:
                if edges[k, side] == OPEN:
                    edges[k, side] = face
                return count
    if count < len(edges):
        edges[count, 0], edges[count, 1], edges[count, 2], edges[count, 3] = a, b, face, OPEN
        count += 1
    return count


@njit(cache=True, nogil=True, error_model="numpy")
def _third(vertices, edges, count, s, t):
    """The vertex left of an edge whose circle with the edge holds no other; none on the hull."""
    best = _NONE
    x, z, radius = _ZERO, _ZERO, -_ONE
    ax, az = vertices[s, 0], vertices[s, 2]
    bx, bz = vertices[t, 0] - ax, vertices[t, 2] - az
    for u in range(len(vertices)):
        cx, cz = vertices[u, 0] - ax, vertices[u, 2] - az
        cross = bx * cz - bz * cx
        if u in (s, t) or not cross > _LEAST_CROSS:
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
        bb, cc = bx * bx + bz * bz, cx * cx + cz * cz
        x = (bb * cz + cc * (_ZERO - bz)) / (_TWO * cross)
        z = (bb * (_ZERO - cx) + cc * bx) / (_TWO * cross)
        x, z, radius = x + ax, z + az, math.sqrt(x * x + z * z)
    return best


@njit(cache=True, nogil=True)
def _overlaps(vertices, edges, count, a, b):
    """Whether the segment between two vertices crosses an edge."""
    for k in range(count):
        c, d = edges[k, 0], edges[k, 1]
        if c in (a, b) or d in (a, b):
            continue
        a1, a2 = _cross(vertices, c, d, b), _cross(vertices, c, d, a)
        if a1 * a2 < _ZERO:
            a3 = _cross(vertices, a, b, c)
            if a3 * (a3 + a2 - a1) < _ZERO:
                return True
    return False


@njit(cache=True, nogil=True)
def _cross(vertices, a, b, c):
    ax, az = vertices[a, 0], vertices[a, 2]
    bx, bz = vertices[b, 0] - ax, vertices[b, 2] - az
    return bx * (vertices[c, 2] - az) - bz * (vertices[c, 0] - ax)
