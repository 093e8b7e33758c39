"""Delaunay triangulations of detail vertices, as ``delaunayHull`` of Recast."""

import numpy as np
from jaxtyping import Float32

from hypernav.worlds.navmesh.recast.detail.delaunay_kernels import HULL, OPEN, complete

_NONE = -1


def delaunay(vertices: Float32[np.ndarray, "n 3"], hull: list[int]) -> list[list[int]]:
    """Delaunay triangles of vertices within a hull, by their corners.

    Args:
        vertices: The vertices, metres; the triangles are those in the plane of x and z.
        hull: Numbers of those on the hull, in order.
    """
    edges = np.full((len(vertices) * 10, 4), OPEN)
    for k, end in enumerate(hull):
        edges[k, :3] = hull[k - 1], end, HULL
    count, faces = complete(vertices, edges, len(hull))
    triangles = [[_NONE] * 3 for _ in range(faces)]
    for a, b, left, right in edges[:count].tolist():
        if right >= 0:
            _take(triangles[right], a, b)
        if left >= 0:
            _take(triangles[left], b, a)
    k = 0
    while k < len(triangles):
        if _NONE in triangles[k]:
            # What is not closed gives way to the last one.
            last = triangles.pop()
            if k < len(triangles):
                triangles[k] = last
        else:
            k += 1
    return triangles


def _take(triangle: list[int], a: int, b: int) -> None:
    """Enter an edge from a to b into a triangle."""
    if triangle[0] == _NONE:
        triangle[:2] = a, b
    elif triangle[0] == b:
        triangle[2] = a
    elif triangle[1] == a:
        triangle[2] = b
