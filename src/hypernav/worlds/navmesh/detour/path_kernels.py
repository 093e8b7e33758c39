"""Shortest paths over a navigation mesh (numba kernels).

String pulling through a corridor of polygons as in ``dtNavMeshQuery::findStraightPath``, called as
in habitat-sim's ``PathFinder``.
"""

import numpy as np
from numba import njit

from hypernav.worlds.navmesh.detour.corridor_kernels import (
    MOST_POLYGONS,
    corridor,
    first_link,
    portal,
)
from hypernav.worlds.navmesh.detour.geometry_kernels import (
    ZERO,
    closest_on_boundary,
    distance,
    is_same,
    signed_area,
    to_segment,
)
from hypernav.worlds.navmesh.detour.nearest_kernels import ANY_ISLAND, NOWHERE, nearest

NO_PATH = np.float32(np.inf)

_EQUAL = np.float32(1e-5)
_NEAR_SQUARED = np.float32(1e-6)


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
