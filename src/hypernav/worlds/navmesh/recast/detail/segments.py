"""Distances to the sides of polygons, single precision, as ``RecastMeshDetail.cpp``."""

import numpy as np
from jaxtyping import Bool, Float32

Point = Float32[np.ndarray, " 3"]
Points = Float32[np.ndarray, "... 3"]
Gaps = Float32[np.ndarray, "..."]
_ZERO, _ONE = np.float32(0.0), np.float32(1.0)


def squared_to_segment(p: Points, a: Point, b: Point) -> Gaps:
    """Squared distances in space from points to one segment."""
    u, d = b - a, p - a
    length = u[0] * u[0] + u[1] * u[1] + u[2] * u[2]
    t = u[0] * d[:, 0] + u[1] * d[:, 1] + u[2] * d[:, 2]
    if length > _ZERO:
        t = t / length
    gap = a + np.clip(t, _ZERO, _ONE)[:, None] * u - p
    x, y, z = gap.T
    return x * x + y * y + z * z


def squared_to_sides(points: Points, outline: Points) -> Gaps:
    """Squared distances in the plane from points to the sides of a polygon.

    The k-th side runs from the corner before the k-th one to it.
    """
    b = outline
    a = np.roll(outline, 1, axis=0)
    ux, uz = b[:, 0] - a[:, 0], b[:, 2] - a[:, 2]
    x, z = points[:, None, 0], points[:, None, 2]
    dx, dz = x - a[:, 0], z - a[:, 2]
    length = ux * ux + uz * uz
    t = ux * dx + uz * dz
    t = np.clip(t / np.where(length > _ZERO, length, _ONE), _ZERO, _ONE)
    dx, dz = a[:, 0] + t * ux - x, a[:, 2] + t * uz - z
    return dx * dx + dz * dz


def is_inside(points: Points, outline: Points) -> Bool[np.ndarray, "..."]:
    """Whether points lie within a polygon, in the plane."""
    a, b = outline, np.roll(outline, 1, axis=0)
    x, z = points[:, None, 0], points[:, None, 2]
    spans = (a[:, 2] > z) != (b[:, 2] > z)
    with np.errstate(divide="ignore", invalid="ignore"):
        left = x < (b[:, 0] - a[:, 0]) * (z - a[:, 2]) / (b[:, 2] - a[:, 2]) + a[:, 0]
    return (spans & left).sum(axis=1) % 2 == 1


def least_width(outline: Points) -> np.float32:
    """The least width of a convex polygon, by its sides."""
    gaps = squared_to_sides(outline, outline)
    return np.sqrt(gaps.max(axis=0).min())
