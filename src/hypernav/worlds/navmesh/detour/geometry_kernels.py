"""Detour's plane geometry (numba kernels).

All arithmetic is in single precision and in Detour's order, so that ties between polygons are
decided equally. Points are tuples ``(x, y, z)``, y up; "plane" means x and z.
"""

import math

import numpy as np
from numba import njit

ZERO = np.float32(0.0)
HALF = np.float32(0.5)
ONE = np.float32(1.0)
FARTHEST = np.float32(np.finfo(np.float32).max)
_SAME_SQUARED = np.float32((1.0 / 16384.0) ** 2)
_PARALLEL = np.float32(1e-6)


@njit(cache=True)
def vertex(mesh, i):
    """A vertex as a point."""
    return mesh.vertices[i, 0], mesh.vertices[i, 1], mesh.vertices[i, 2]


@njit(cache=True)
def corner(mesh, polygon, i):
    """A corner of a polygon as a point."""
    return vertex(mesh, mesh.corners[polygon, i])


@njit(cache=True)
def between(a, b, t):
    """The point at a fraction of the straight line from a to b."""
    return (
        a[0] + (b[0] - a[0]) * t,
        a[1] + (b[1] - a[1]) * t,
        a[2] + (b[2] - a[2]) * t,
    )


@njit(cache=True)
def squared_distance(a, b):
    """Squared distance in space."""
    dx, dy, dz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    return dx * dx + dy * dy + dz * dz


@njit(cache=True)
def distance(a, b):
    """Distance in space."""
    return math.sqrt(squared_distance(a, b))


@njit(cache=True)
def is_same(a, b):
    """Whether two points are closer than a sixteenth of a millimetre."""
    return squared_distance(a, b) < _SAME_SQUARED


@njit(cache=True)
def signed_area(a, b, c):
    """Twice the area of a triangle in the plane; its sign tells the side of c."""
    return (c[0] - a[0]) * (b[2] - a[2]) - (b[0] - a[0]) * (c[2] - a[2])


@njit(cache=True)
def to_segment(p, a, b):
    """Squared distance from p to the segment a-b in the plane, and where on it, 0 to 1."""
    abx, abz = b[0] - a[0], b[2] - a[2]
    dx, dz = p[0] - a[0], p[2] - a[2]
    length = abx * abx + abz * abz
    t = abx * dx + abz * dz
    if length > ZERO:
        t = t / length
    t = min(max(t, ZERO), ONE)
    dx = a[0] + t * abx - p[0]
    dz = a[2] + t * abz - p[2]
    return dx * dx + dz * dz, t


@njit(cache=True)
def crossing(a, b, c, d):
    """Whether the lines a-b and c-d cross in the plane, and where on each: 0 to 1 is within."""
    ux, uz = b[0] - a[0], b[2] - a[2]
    vx, vz = d[0] - c[0], d[2] - c[2]
    wx, wz = a[0] - c[0], a[2] - c[2]
    cross = ux * vz - uz * vx
    if abs(cross) < _PARALLEL:
        return False, ZERO, ZERO
    return True, (vx * wz - vz * wx) / cross, (ux * wz - uz * wx) / cross


@njit(cache=True)
def is_over(mesh, polygon, p):
    """Whether a point lies over or under a polygon."""
    inside = False
    count = mesh.corner_count[polygon]
    b = corner(mesh, polygon, count - 1)
    for i in range(count):
        a = corner(mesh, polygon, i)
        if (a[2] > p[2]) != (b[2] > p[2]) and p[0] < (b[0] - a[0]) * (p[2] - a[2]) / (
            b[2] - a[2]
        ) + a[0]:
            inside = not inside
        b = a
    return inside


@njit(cache=True)
def height_in_triangle(p, a, b, c):
    """Whether a point lies over or under a triangle, and the triangle's height there."""
    v0x, v0y, v0z = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    v1x, v1y, v1z = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    v2x, v2z = p[0] - a[0], p[2] - a[2]
    area = v0x * v1z - v0z * v1x
    if abs(area) < _PARALLEL:
        return False, ZERO
    u = v1z * v2x - v1x * v2z
    v = v0x * v2z - v0z * v2x
    if area < ZERO:
        area, u, v = -area, -u, -v
    if u >= ZERO and v >= ZERO and u + v <= area:
        return True, a[1] + (v0y * u + v1y * v) / area
    return False, ZERO


@njit(cache=True)
def closest_on_boundary(mesh, polygon, p):
    """The point itself if it lies over a polygon, else the closest one on the polygon's edges."""
    if is_over(mesh, polygon, p):
        return p
    count = mesh.corner_count[polygon]
    nearest = FARTHEST
    closest = p
    for i in range(count):
        a, b = corner(mesh, polygon, i), corner(mesh, polygon, (i + 1) % count)
        gap, t = to_segment(p, a, b)
        if gap < nearest:
            nearest = gap
            closest = between(a, b, t)
    return closest
