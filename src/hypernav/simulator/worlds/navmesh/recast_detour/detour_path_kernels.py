"""Shortest paths over a navigation mesh (numba kernels).

A* over the polygons is that of ``dtNavMeshQuery::findPath``, with the limits of habitat-sim, so
that searches fail in the same cases. String pulling through the corridor of polygons that it finds
is that of ``dtNavMeshQuery::findStraightPath``, called as in habitat-sim's ``PathFinder``.
"""

import numpy as np
from numba import njit

from hypernav.simulator.worlds.navmesh.recast_detour.detour_kernels import (
    ANY_ISLAND,
    HALF,
    NOWHERE,
    ONE,
    ZERO,
    between,
    closest_on_boundary,
    corner,
    distance,
    is_same,
    lower,
    nearest,
    pop,
    push,
    signed_area,
    to_segment,
)
from hypernav.simulator.worlds.navmesh.recast_detour.detour_mesh import WITHIN

MOST_NODES = 2048
"""Largest number of polygons that a search may visit."""
MOST_POLYGONS = 256
"""Largest number of polygons, and of corners, of a path."""

_HEURISTIC_SCALE = np.float32(0.999)
_STATES = 4
"""Number of times that a polygon may be visited: once per side on which other tiles lead to it."""
_OPEN = 1
_CLOSED = 2
NO_PATH = np.float32(np.inf)
_EQUAL = np.float32(1e-5)
_NEAR_SQUARED = np.float32(1e-6)


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


@njit(cache=True)
def _append(points, count, point):
    """Add a point to a path unless it equals the last; returns the number of points."""
    if count > 0 and is_same(
        (points[count - 1, 0], points[count - 1, 1], points[count - 1, 2]), point
    ):
        return count
    points[count, 0], points[count, 1], points[count, 2] = point
    return count + 1


@njit(cache=True)
def straight_path(mesh, path, start, end):
    """The string pulled tight through a corridor of polygons.

    Returns:
        Its corners with both ends; none if there are more than habitat-sim's limit.
    """
    points = np.empty((MOST_POLYGONS, 3), dtype=np.float32)
    count = len(path)
    start = closest_on_boundary(mesh, path[0], start)
    end = closest_on_boundary(mesh, path[count - 1], end)
    length = _append(points, 0, start)
    apex, left_end, right_end = start, start, start
    left_at, right_at = 0, 0
    i = 0
    while count > 1 and i < count:
        if i + 1 < count:
            left, right = portal(mesh, first_link(mesh, path[i], path[i + 1]), path[i])
            if i == 0 and to_segment(apex, left, right)[0] < _NEAR_SQUARED:
                i += 1
                continue
        else:
            left, right = end, end
        turned = False
        if signed_area(apex, right_end, right) <= ZERO:
            if is_same(apex, right_end) or signed_area(apex, left_end, right) > ZERO:
                right_end, right_at = right, i
            else:
                apex, i = left_end, left_at
                turned = True
        if not turned and signed_area(apex, left_end, left) >= ZERO:
            if is_same(apex, left_end) or signed_area(apex, right_end, left) < ZERO:
                left_end, left_at = left, i
            else:
                apex, i = right_end, right_at
                turned = True
        if turned:
            before = length
            length = _append(points, length, apex)
            if length > before and length == MOST_POLYGONS:
                return points[:0]
            if length > before and i == count - 1:
                return points[:length]
            left_end, right_end = apex, apex
            left_at, right_at = i, i
        i += 1
    length = _append(points, length, end)
    return points[: length if length < MOST_POLYGONS else 0]


@njit(cache=True)
def shortest_path(mesh, islands, start, start_polygon, start_point, end, end_polygon, end_point):
    """The shortest path between two positions, as habitat-sim's ``PathFinder`` finds it.

    Args:
        mesh: Navigation mesh.
        islands: Island of every polygon.
        start: Position that was asked for.
        start_polygon: Polygon nearest to it.
        start_point: Point on that polygon nearest to it.
        end: As for the start.
        end_polygon: As for the start.
        end_point: As for the start.

    Returns:
        Length and corners with both ends; infinite and none if there is no path.
    """
    points = np.empty((0, 3), dtype=np.float32)
    if _is_equal(start_point, end_point):
        points = np.empty((2, 3), dtype=np.float32)
        for axis in range(3):
            points[0, axis], points[1, axis] = start_point[axis], end_point[axis]
        return ZERO, points
    if islands[start_polygon] != islands[end_polygon]:
        return NO_PATH, points
    path = corridor(mesh, start_polygon, end_polygon, start_point, end_point)
    if len(path) > 0:
        points = straight_path(mesh, path, start, end)
    if len(points) == 0:
        return NO_PATH, points
    length = ZERO
    for i in range(1, len(points)):
        length += distance(
            (points[i - 1, 0], points[i - 1, 1], points[i - 1, 2]),
            (points[i, 0], points[i, 1], points[i, 2]),
        )
    return length, points


@njit(cache=True)
def _is_equal(a, b):
    """Whether two points are equal as Magnum's vectors are, up to a relative rounding error."""
    for axis in range(3):
        gap = abs(a[axis] - b[axis])
        if gap >= _EQUAL and (
            a[axis] == ZERO or b[axis] == ZERO or gap / (abs(a[axis]) + abs(b[axis])) >= _EQUAL
        ):
            return False
    return True


@njit(cache=True)
def path_between(mesh, islands, start, end):
    """The shortest path between two positions; a position off the mesh has none."""
    start_polygon, start_point = nearest(mesh, start, islands, ANY_ISLAND)
    end_polygon, end_point = nearest(mesh, end, islands, ANY_ISLAND)
    if start_polygon == NOWHERE or end_polygon == NOWHERE:
        return NO_PATH, np.empty((0, 3), dtype=np.float32)
    return shortest_path(
        mesh, islands, start, start_polygon, start_point, end, end_polygon, end_point
    )


@njit(cache=True)
def nearest_goal(
    mesh, islands, start, start_polygon, start_point, ends, end_polygons, end_points, bounds
):
    """The goal with the shortest path, as habitat-sim's ``MultiGoalShortestPath``.

    Args:
        mesh: Navigation mesh.
        islands: Island of every polygon.
        start: Position that was asked for.
        start_polygon: Polygon nearest to it.
        start_point: Point on that polygon nearest to it.
        ends: Positions of the goals.
        end_polygons: Polygons nearest to them, `NOWHERE` for those that are off the mesh.
        end_points: Points on those polygons.
        bounds: Lower bounds of the lengths of the paths to the goals; updated with lengths found.

    Returns:
        Its number (`NOWHERE` if no path leads anywhere), and the length and corners of the path.
    """
    best, best_length = NOWHERE, NO_PATH
    best_points = np.empty((0, 3), dtype=np.float32)
    for i in np.argsort(bounds, kind="mergesort"):
        if end_polygons[i] == NOWHERE or bounds[i] > best_length:
            continue
        length, points = shortest_path(
            mesh,
            islands,
            start,
            start_polygon,
            start_point,
            (ends[i, 0], ends[i, 1], ends[i, 2]),
            end_polygons[i],
            (end_points[i, 0], end_points[i, 1], end_points[i, 2]),
        )
        if length < best_length:
            bounds[i] = length
            best, best_length, best_points = i, length, points
    return best, best_length, best_points
