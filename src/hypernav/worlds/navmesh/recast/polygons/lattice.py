"""Plane geometry on whole numbers, as ``RecastContour.cpp`` and ``RecastMesh.cpp``.

Points are arrays whose last axis begins with x, height and z. "Left" is seen with z downwards,
which is the inner side of an outline as it is traced here.
"""

import numpy as np
from jaxtyping import Bool, Int64

Points = Int64[np.ndarray, "..."]
Numbers = Int64[np.ndarray, "..."] | np.int64
Answers = Bool[np.ndarray, "..."] | np.bool_


def area2(a: Points, b: Points, c: Points) -> Numbers:
    """Twice the signed area of triangles; negative if c is left of the line from a to b."""
    ax, az = a[..., 0], a[..., 2]
    return (b[..., 0] - ax) * (c[..., 2] - az) - (c[..., 0] - ax) * (b[..., 2] - az)


def is_same(a: Points, b: Points) -> Answers:
    """Whether two points are equal in the plane."""
    return (a[..., 0] == b[..., 0]) & (a[..., 2] == b[..., 2])


def squared_gap(a: Points, b: Points) -> Numbers:
    """Squared distance in the plane."""
    return (b[..., 0] - a[..., 0]) ** 2 + (b[..., 2] - a[..., 2]) ** 2


def crosses(a: Points, b: Points, c: Points, d: Points) -> Answers:
    """Whether two segments cross at an inner point of both."""
    return (np.sign(area2(a, b, c)) * np.sign(area2(a, b, d)) < 0) & (
        np.sign(area2(c, d, a)) * np.sign(area2(c, d, b)) < 0
    )


def touches(a: Points, b: Points, c: Points, d: Points) -> Answers:
    """Whether two segments have a point in common."""
    return (
        crosses(a, b, c, d)
        | _between(a, b, c)
        | _between(a, b, d)
        | _between(c, d, a)
        | _between(c, d, b)
    )


def is_in_cone(before: Points, corner: Points, after: Points, point: Points) -> Answers:
    """Whether a point lies strictly in the inner angle of an outline's corner."""
    convex = (area2(corner, point, before) < 0) & (area2(point, corner, after) < 0)
    outside = (area2(corner, point, after) <= 0) & (area2(point, corner, before) <= 0)
    return np.where(area2(before, corner, after) <= 0, convex, ~outside)


def is_in_closed_cone(before: Points, corner: Points, after: Points, point: Points) -> Answers:
    """The same, with the sides of a convex corner."""
    convex = (area2(corner, point, before) <= 0) & (area2(point, corner, after) <= 0)
    outside = (area2(corner, point, after) <= 0) & (area2(point, corner, before) <= 0)
    return np.where(area2(before, corner, after) <= 0, convex, ~outside)


def _between(a: Points, b: Points, c: Points) -> Answers:
    """Whether c lies on the segment from a to b."""
    within = np.where(
        a[..., 0] != b[..., 0],
        (c[..., 0] - a[..., 0]) * (c[..., 0] - b[..., 0]) <= 0,
        (c[..., 2] - a[..., 2]) * (c[..., 2] - b[..., 2]) <= 0,
    )
    return within & (area2(a, b, c) == 0)
