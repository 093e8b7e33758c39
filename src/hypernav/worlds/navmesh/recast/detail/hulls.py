"""Triangles of hulls without inner vertices, as ``RecastMeshDetail.cpp``."""

import numpy as np

from hypernav.worlds.navmesh.recast.detail.segments import Points


def triangles_of_hull(
    vertices: Points, hull: list[int], corners: int
) -> list[tuple[int, int, int]]:
    """Triangles of a convex hull without inner vertices.

    Args:
        vertices: All vertices, metres.
        hull: Numbers of those on the hull, in order.
        corners: Number of the polygon's own corners, which come first of the vertices.
    """
    count = len(hull)
    points = vertices[hull]
    dx, dz = (points[:, None, axis] - points[None, :, axis] for axis in (0, 2))
    gap = np.sqrt(dx * dx + dz * dz)
    ring = np.arange(count)
    before, after = np.roll(ring, 1), np.roll(ring, -1)
    perimeter = gap[before, ring] + gap[ring, after] + gap[after, before]
    perimeter[np.array(hull) >= corners] = np.inf
    start = int(perimeter.argmin())
    left, right = (start + 1) % count, (start - 1) % count
    triangles = [(hull[start], hull[left], hull[right])]
    while (left + 1) % count != right:
        next_left, next_right = (left + 1) % count, (right - 1) % count
        if (
            gap[left, next_left] + gap[next_left, right]
            < gap[right, next_right] + gap[left, next_right]
        ):
            triangles.append((hull[left], hull[next_left], hull[right]))
            left = next_left
        else:
            triangles.append((hull[left], hull[next_right], hull[right]))
            right = next_right
    return triangles
