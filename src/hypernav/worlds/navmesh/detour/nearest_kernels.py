"""The polygon and the point of a navigation mesh that are nearest to a point (numba kernels).

As Detour's ``dtNavMesh::getPolyHeight``, ``closestPointOnPoly`` and
``dtNavMeshQuery::findNearestPoly``, with habitat-sim's search box.
"""

import math

import numpy as np
from numba import njit

from hypernav.worlds.navmesh.detour.geometry_kernels import (
    FARTHEST,
    ZERO,
    between,
    height_in_triangle,
    is_over,
    squared_distance,
    to_segment,
    vertex,
)

NOWHERE = -1
ANY_ISLAND = np.int64(NOWHERE)
"""Searches all islands. Numba would compile `nearest` once more for a constant of Python."""
_REACH = (np.float32(2.0), np.float32(4.0), np.float32(2.0))
"""Half the sides of habitat-sim's search box, metres."""
_ON_BOUNDARY = (np.uint8(1), np.uint8(4), np.uint8(16))
"""Flags of a detail triangle's edges 0-1, 1-2 and 2-0."""
_FINEST = np.float32(65535.0)


@njit(cache=True)
def _on_detail_edges(mesh, polygon, p, only_boundary):
    """The closest point on the edges of a polygon's detail triangles, in the plane."""
    nearest = FARTHEST
    closest = p
    for triangle in range(mesh.triangle_start[polygon], mesh.triangle_start[polygon + 1]):
        # Detour begins with the edge from the last to the first corner; ties go to the first.
        for k in range(3):
            j = (k + 2) % 3
            if only_boundary and mesh.triangle_flags[triangle] & _ON_BOUNDARY[j] == 0:
                continue
            a = vertex(mesh, mesh.triangles[triangle, j])
            b = vertex(mesh, mesh.triangles[triangle, k])
            gap, t = to_segment(p, a, b)
            if gap < nearest:
                nearest = gap
                closest = between(a, b, t)
    return closest


@njit(cache=True)
def height_on(mesh, polygon, p):
    """Whether a point lies over or under a polygon, and the surface's height there."""
    if not is_over(mesh, polygon, p):
        return False, ZERO
    for triangle in range(mesh.triangle_start[polygon], mesh.triangle_start[polygon + 1]):
        corners = mesh.triangles[triangle]
        found, height = height_in_triangle(
            p, vertex(mesh, corners[0]), vertex(mesh, corners[1]), vertex(mesh, corners[2])
        )
        if found:
            return True, height
    # By rounding a point may lie in none of the triangles.
    return True, _on_detail_edges(mesh, polygon, p, False)[1]


@njit(cache=True)
def closest_on(mesh, polygon, p):
    """The closest point of a polygon's surface, and whether the point lies over or under it."""
    over, height = height_on(mesh, polygon, p)
    if over:
        return (p[0], height, p[2]), True
    return _on_detail_edges(mesh, polygon, p, _has_boundary(mesh, polygon)), False


@njit(cache=True)
def _has_boundary(mesh, polygon):
    """Whether an edge is marked as boundary; Detour would crash beside a polygon without one."""
    for triangle in range(mesh.triangle_start[polygon], mesh.triangle_start[polygon + 1]):
        for flag in _ON_BOUNDARY:
            if mesh.triangle_flags[triangle] & flag != 0:
                return True
    return False


@njit(cache=True)
def nearest(mesh, p, islands, island):
    """The polygon nearest to a point, and the point on it.

    Over or under a polygon only the height counts, as far as it exceeds the agent's climb.

    Args:
        mesh: Navigation mesh.
        p: Point.
        islands: Island of every polygon.
        island: The only island to search, or `ANY_ISLAND`.

    Returns:
        The polygon (`NOWHERE` if there is none in reach) and the point.
    """
    low = (p[0] - _REACH[0], p[1] - _REACH[1], p[2] - _REACH[2])
    high = (p[0] + _REACH[0], p[1] + _REACH[1], p[2] + _REACH[2])
    best, best_gap, best_point = NOWHERE, FARTHEST, p
    if not (math.isfinite(p[0]) and math.isfinite(p[1]) and math.isfinite(p[2])):
        return best, best_point
    first_x, first_y = _location(mesh, low)
    last_x, last_y = _location(mesh, high)
    for tile in range(len(mesh.tile_x)):
        if not (first_x <= mesh.tile_x[tile] <= last_x and first_y <= mesh.tile_y[tile] <= last_y):
            continue
        node, end = mesh.tile_node[tile], mesh.tile_node[tile + 1]
        box_low, box_high = _quantised(mesh, tile, low, high)
        while node < end:
            overlaps = True
            for axis in range(3):
                if (
                    box_low[axis] > mesh.node_high[node, axis]
                    or box_high[axis] < mesh.node_low[node, axis]
                ):
                    overlaps = False
            index = mesh.node_index[node]
            if index < 0 and not overlaps:
                node -= index
                continue
            node += 1
            if index < 0 or not overlaps:
                continue
            polygon = mesh.tile_polygon[tile] + index
            if not mesh.walkable[polygon] or (island != ANY_ISLAND and islands[polygon] != island):
                continue
            point, over = closest_on(mesh, polygon, p)
            if over:
                gap = abs(p[1] - point[1]) - mesh.tile_climb[tile]
                gap = gap * gap if gap > ZERO else ZERO
            else:
                gap = squared_distance(point, p)
            if gap < best_gap:
                best, best_gap, best_point = polygon, gap, point
    return best, best_point


@njit(cache=True)
def _location(mesh, p):
    """Column and row of the tile at a point."""
    return (
        math.floor((p[0] - mesh.grid[0]) / mesh.grid[2]),
        math.floor((p[2] - mesh.grid[1]) / mesh.grid[3]),
    )


@njit(cache=True)
def _quantised(mesh, tile, low, high):
    """A box in the steps of a tile's tree."""
    factor = mesh.tile_quantisation[tile]
    first = np.empty(3, dtype=np.int32)
    last = np.empty(3, dtype=np.int32)
    for axis in range(3):
        from_, to = mesh.tile_low[tile, axis], mesh.tile_high[tile, axis]
        first[axis] = np.int32(min(factor * (min(max(low[axis], from_), to) - from_), _FINEST)) & ~1
        last[axis] = (
            np.int32(
                min(factor * (min(max(high[axis], from_), to) - from_) + np.float32(1.0), _FINEST)
            )
            | 1
        )
    return first, last
