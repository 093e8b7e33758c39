"""Plane geometry on integers (numba kernels), as ``RecastContour.cpp`` and ``RecastMesh.cpp``.

Points are rows whose first and third number are x and z. "Left" is seen with z downwards, which is
the inner side of an outline as it is traced here.
"""

from numba import njit

_X, _Z = 0, 2


@njit(cache=True, nogil=True)
def area2(a, b, c):
    """Twice the signed area of a triangle; negative if c is left of the line from a to b."""
    return (b[_X] - a[_X]) * (c[_Z] - a[_Z]) - (c[_X] - a[_X]) * (b[_Z] - a[_Z])


@njit(cache=True, nogil=True)
def is_same(a, b):
    """Whether two points are equal in the plane."""
    return a[_X] == b[_X] and a[_Z] == b[_Z]


@njit(cache=True, nogil=True)
def squared_gap(a, b):
    """Squared distance in the plane."""
    dx, dz = b[_X] - a[_X], b[_Z] - a[_Z]
    return dx * dx + dz * dz


@njit(cache=True, nogil=True)
def crosses(a, b, c, d):
    """Whether two segments cross at an inner point of both."""
    abc, abd, cda, cdb = area2(a, b, c), area2(a, b, d), area2(c, d, a), area2(c, d, b)
    if abc == 0 or abd == 0 or cda == 0 or cdb == 0:
        return False
    return (abc < 0) != (abd < 0) and (cda < 0) != (cdb < 0)


@njit(cache=True, nogil=True)
def touches(a, b, c, d):
    """Whether two segments have a point in common."""
    return (
        crosses(a, b, c, d)
        or _between(a, b, c)
        or _between(a, b, d)
        or _between(c, d, a)
        or _between(c, d, b)
    )


@njit(cache=True, nogil=True)
def is_in_cone(before, corner, after, point):
    """Whether a point lies strictly in the inner angle of an outline's corner."""
    if area2(before, corner, after) <= 0:
        return area2(corner, point, before) < 0 and area2(point, corner, after) < 0
    return not (area2(corner, point, after) <= 0 and area2(point, corner, before) <= 0)


@njit(cache=True, nogil=True)
def is_in_closed_cone(before, corner, after, point):
    """The same, including the sides of a convex corner."""
    if area2(before, corner, after) <= 0:
        return area2(corner, point, before) <= 0 and area2(point, corner, after) <= 0
    return not (area2(corner, point, after) <= 0 and area2(point, corner, before) <= 0)


@njit(cache=True, nogil=True)
def _between(a, b, c):
    """Whether c lies on the segment from a to b."""
    if area2(a, b, c) != 0:
        return False
    axis = _X if a[_X] != b[_X] else _Z
    return a[axis] <= c[axis] <= b[axis] or a[axis] >= c[axis] >= b[axis]
