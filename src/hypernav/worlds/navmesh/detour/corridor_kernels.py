"""A* over the polygons of a navigation mesh, as ``dtNavMeshQuery::findPath`` (numba kernels).

The limits are those of habitat-sim, so searches fail in the same cases.
"""

import numpy as np
from numba import njit

from hypernav.worlds.navmesh.detour.geometry_kernels import (
    HALF,
    ONE,
    ZERO,
    between,
    corner,
    distance,
)
from hypernav.worlds.navmesh.detour.heap_kernels import lower, pop, push
from hypernav.worlds.navmesh.detour.nearest_kernels import NOWHERE
from hypernav.worlds.navmesh.detour.tile_links import WITHIN

MOST_NODES = 2048
"""Largest number of polygons that a search may visit."""
MOST_POLYGONS = 256
"""Largest number of polygons, and of corners, of a path."""

_HEURISTIC_SCALE = np.float32(0.999)
_STATES = 4
"""Number of times that a polygon may be visited: once per side on which other tiles lead to it."""
_OPEN = 1
_CLOSED = 2


@njit(cache=True)
def portal(mesh, link, polygon):
    """Both ends of the edge that a link leads over."""
    edge = mesh.link_edge[link]
    left = corner(mesh, polygon, edge)
    right = corner(mesh, polygon, (edge + 1) % mesh.corner_count[polygon])
    low, high = mesh.link_low[link], mesh.link_high[link]
    if mesh.link_side[link] != WITHIN and (low != 0 or high != 255):
        step = ONE / np.float32(255.0)
        return (
            between(left, right, np.float32(low) * step),
            between(left, right, np.float32(high) * step),
        )
    return left, right


@njit(cache=True)
def first_link(mesh, polygon, neighbour):
    """The first link from a polygon to its neighbour."""
    for link in range(mesh.link_start[polygon], mesh.link_start[polygon + 1]):
        if mesh.link_polygon[link] == neighbour:
            return link
    return NOWHERE


@njit(cache=True)
def corridor(mesh, start_polygon, end_polygon, start, end):
    """Polygons of the cheapest path between two points on them.

    Returns:
        The polygons from the first to the last; none if there is no path, or if habitat-sim would
        not find it.
    """
    nothing = np.empty(0, dtype=np.int32)
    if start_polygon == end_polygon:
        return np.full(1, start_polygon, dtype=np.int32)
    node_of = np.full(len(mesh.corner_count) * _STATES, -1, dtype=np.int32)
    polygons = np.empty(MOST_NODES, dtype=np.int32)
    places = np.empty((MOST_NODES, 3), dtype=np.float32)
    parents = np.empty(MOST_NODES, dtype=np.int32)
    flags = np.empty(MOST_NODES, dtype=np.uint8)
    cost = np.empty(MOST_NODES, dtype=np.float32)
    total = np.empty(MOST_NODES, dtype=np.float32)
    heap = np.empty(MOST_NODES, dtype=np.int32)
    node_of[start_polygon * _STATES] = 0
    polygons[0], parents[0], flags[0] = start_polygon, -1, _OPEN
    places[0, 0], places[0, 1], places[0, 2] = start
    cost[0] = ZERO
    total[0] = distance(start, end) * _HEURISTIC_SCALE
    nodes = 1
    heap_size = push(heap, 0, 0, total)
    last = -1
    while heap_size > 0:
        best, heap_size = pop(heap, heap_size, total)
        flags[best] = _CLOSED
        polygon = polygons[best]
        if polygon == end_polygon:
            last = best
            break
        here = (places[best, 0], places[best, 1], places[best, 2])
        parent = polygons[parents[best]] if parents[best] >= 0 else NOWHERE
        for link in range(mesh.link_start[polygon], mesh.link_start[polygon + 1]):
            neighbour = mesh.link_polygon[link]
            if neighbour == parent or not mesh.walkable[neighbour]:
                continue
            side = mesh.link_side[link]
            key = neighbour * _STATES + (side // 2 if side != WITHIN else 0)
            node = node_of[key]
            if node < 0:
                if nodes == MOST_NODES:
                    return nothing
                node = nodes
                nodes += 1
                node_of[key] = node
                polygons[node], flags[node] = neighbour, 0
                left, right = portal(mesh, first_link(mesh, polygon, neighbour), polygon)
                for axis in range(3):
                    places[node, axis] = (left[axis] + right[axis]) * HALF
            there = (places[node, 0], places[node, 1], places[node, 2])
            new_cost = cost[best] + distance(here, there)
            if neighbour == end_polygon:
                new_cost = cost[best] + distance(here, there) + distance(there, end)
                new_total = new_cost
            else:
                new_total = new_cost + distance(there, end) * _HEURISTIC_SCALE
            if flags[node] != 0 and new_total >= total[node]:
                continue
            parents[node] = best
            cost[node], total[node] = new_cost, new_total
            if flags[node] == _OPEN:
                lower(heap, heap_size, node, total)
            else:
                flags[node] = _OPEN
                heap_size = push(heap, heap_size, node, total)
    if last < 0:
        return nothing
    count = 0
    node = last
    while node >= 0:
        count += 1
        node = parents[node]
    if count > MOST_POLYGONS:
        return nothing
    path = np.empty(count, dtype=np.int32)
    while last >= 0:
        count -= 1
        path[count] = polygons[last]
        last = parents[last]
    return path
