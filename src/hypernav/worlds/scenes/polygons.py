"""Cuts polygons into triangles: a fan where that is right, ears where a polygon is not convex.

A wall with a doorway is often one polygon; a fan would close the doorway.
"""

import numpy as np
from jaxtyping import Float64, Int64

_BACKWARDS = -1e-6
"""Cosine below which a triangle of a fan faces against its polygon."""
_MOST_CORNERS = 1000
"""Polygons with more corners stay fans."""


def triangles_of_polygons(
    counts: Int64[np.ndarray, "polygons"], points: Float64[np.ndarray, "corners 3"]
) -> Int64[np.ndarray, "faces 3"]:
    """Numbers of the corners of triangles that cover polygons, without a new corner.

    Args:
        counts: Number of corners of every polygon; those with fewer than three have no triangle.
        points: Positions of their corners, one polygon after the other.
    """
    starts = np.cumsum(counts) - counts
    triangles = np.maximum(counts - 2, 0)
    polygon = np.repeat(np.arange(len(counts)), triangles)
    hub = np.repeat(starts, triangles)
    step = np.arange(len(hub)) - np.repeat(np.cumsum(triangles) - triangles, triangles)
    fans = np.stack([hub, hub + step + 1, hub + step + 2], axis=1).astype(np.int64)
    a, b, c = points[fans].transpose(1, 0, 2)
    with np.errstate(all="ignore"):  # a corner that is no number faces nowhere
        areas = np.cross(b - a, c - a)
        normals = np.zeros((len(counts), 3))
        np.add.at(normals, polygon, areas)
        sizes = np.linalg.norm(areas, axis=1) * np.linalg.norm(normals[polygon], axis=1)
        against = np.einsum("fk,fk->f", areas, normals[polygon]) < _BACKWARDS * sizes
    bent = np.unique(polygon[against])
    bent = bent[counts[bent] <= _MOST_CORNERS]
    ears = [
        starts[k] + _ears(points[starts[k] : starts[k] + counts[k]], normals[k])
        for k in bent.tolist()
    ]
    return np.concatenate([fans[~np.isin(polygon, bent)], *ears])


def _ears(
    points: Float64[np.ndarray, "n 3"], normal: Float64[np.ndarray, "3"]
) -> Int64[np.ndarray, "faces 3"]:
    """Triangles of one polygon: corners that nothing lies in are cut off, one after the other."""
    # The axis that the normal is farthest from gives the plane its first direction.
    right = np.cross(normal, np.eye(3)[int(np.abs(normal).argmin())])
    flat = points @ np.stack([right, np.cross(normal, right)], axis=1)
    left = list(range(len(points)))
    found: list[tuple[int, int, int]] = []
    while len(left) > 3:
        ear = next((k for k in range(len(left)) if _is_ear(flat, left, k)), None)
        if ear is None:  # it crosses itself: what is left stays a fan
            break
        found.append((left[ear - 1], left[ear], left[(ear + 1) % len(left)]))
        del left[ear]
    found += [(left[0], left[k], left[k + 1]) for k in range(1, len(left) - 1)]
    return np.array(found, dtype=np.int64)


def _is_ear(flat: Float64[np.ndarray, "n 2"], left: list[int], k: int) -> bool:
    a, b, c = flat[left[k - 1]], flat[left[k]], flat[left[(k + 1) % len(left)]]
    if _side(a, b, c[None])[0] <= 0.0:
        return False
    others = flat[left]
    inside = (_side(a, b, others) > 0.0) & (_side(b, c, others) > 0.0) & (_side(c, a, others) > 0.0)
    return not inside.any()


def _side(
    a: Float64[np.ndarray, "2"], b: Float64[np.ndarray, "2"], points: Float64[np.ndarray, "n 2"]
) -> Float64[np.ndarray, "n"]:
    """Positive for points to the left of the line from a to b."""
    (x, y), relative = b - a, points - a
    return x * relative[:, 1] - y * relative[:, 0]
