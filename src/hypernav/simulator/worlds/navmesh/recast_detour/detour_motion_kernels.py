"""Straight moves on a navigation mesh (numba kernels).

As ``dtNavMeshQuery::moveAlongSurface`` of habitat-sim's Detour, and its ``PathFinder::tryStep``.
"""

import numpy as np
from numba import njit

from hypernav.simulator.worlds.navmesh.recast_detour.detour_kernels import (
    ANY_ISLAND,
    FARTHEST,
    HALF,
    NOWHERE,
    ONE,
    ZERO,
    between,
    corner,
    crossing,
    distance,
    height_on,
    is_over,
    nearest,
    to_segment,
)
from hypernav.simulator.worlds.navmesh.recast_detour.detour_mesh import OTHER_TILE

_MOST_NEAR = 64
"""Largest number of polygons that one move may touch."""
_MOST_WAITING = 48
_MOST_NEIGHBOURS = 8
"""Largest number of neighbours in another tile over one edge."""
_SLACK = np.float32(0.001)
_NUDGE = np.float32(1e-4)


@njit(cache=True)
def _neighbours(mesh, polygon, edge, found):
    """Walkable polygons behind an edge; writes them to an array and returns their number."""
    neighbour = mesh.neighbours[polygon, edge]
    if neighbour >= 0:
        found[0] = neighbour
        return 1 if mesh.walkable[neighbour] else 0
    count = 0
    if neighbour == OTHER_TILE:
        for link in range(mesh.link_start[polygon], mesh.link_start[polygon + 1]):
            other = mesh.link_polygon[link]
            if mesh.link_edge[link] == edge and mesh.walkable[other] and count < len(found):
                found[count] = other
                count += 1
    return count


@njit(cache=True)
def _hits(a, b, start, end):
    """Whether a move meets a segment, and where on the segment."""
    cross, s, t = crossing(a, b, start, end)
    return cross and ZERO <= t <= ONE and ZERO <= s <= ONE, s


@njit(cache=True)
def _stop_at(a, b, start, end, straight):
    """Squared distance from where a wall ends a move to the move's end, and that point."""
    if not straight:
        gap, t = to_segment(end, a, b)
        return gap, between(a, b, t)
    met, t = _hits(a, b, start, end)
    stop = between(a, b, t)
    dx, dz = end[0] - stop[0], end[2] - stop[2]
    return (dx * dx + dz * dz if met else FARTHEST), stop


@njit(cache=True)
def move(mesh, start_polygon, start, end, sliding, to_last_wall):
    """The end of a straight move from a point on a polygon.

    Without sliding, only polygons that the line enters are on its way, and a wall ends it unless
    its end is reached, so a robot on a wall may leave it. To the last wall, the move with sliding
    is computed first and then cut back at the wall, among the polygons on the way, that crosses
    the line.

    Returns:
        The point, not yet at the height of the surface, and the polygon where the search ends,
        which is `NOWHERE` if there is no such move.
    """
    polygons = np.empty(_MOST_NEAR, dtype=np.int32)
    parents = np.full(_MOST_NEAR, -1, dtype=np.int32)
    visited = np.zeros(_MOST_NEAR, dtype=np.bool_)
    waiting = np.empty(_MOST_NEAR, dtype=np.int32)
    found = np.empty(_MOST_NEIGHBOURS, dtype=np.int32)
    polygons[0], visited[0], waiting[0] = start_polygon, True, 0
    nodes, first, last = 1, 0, 1
    best, best_point, best_gap = -1, start, FARTHEST
    straight = not (sliding or to_last_wall)
    middle = between(start, end, HALF)
    radius = distance(start, end) * HALF + _SLACK
    radius_squared = radius * radius
    while first < last:
        current = waiting[first]
        polygon = polygons[current]
        first += 1
        if is_over(mesh, polygon, end):
            best, best_point = current, end
            break
        count = mesh.corner_count[polygon]
        edge = count - 1
        for i in range(count):
            a, b = corner(mesh, polygon, edge), corner(mesh, polygon, i)
            beyond = _neighbours(mesh, polygon, edge, found)
            edge = i
            if beyond == 0:
                gap, stop = _stop_at(a, b, start, end, straight)
                if gap < best_gap:
                    best, best_point, best_gap = current, stop, gap
            for k in range(beyond):
                node = 0
                while node < nodes and polygons[node] != found[k]:
                    node += 1
                if node == nodes:
                    if nodes == _MOST_NEAR:
                        continue
                    polygons[node] = found[k]
                    nodes += 1
                if visited[node] or to_segment(middle, a, b)[0] > radius_squared:
                    continue
                if straight and not _hits(a, b, start, end)[0]:
                    continue
                if last - first < _MOST_WAITING:
                    visited[node], parents[node] = True, current
                    waiting[last] = node
                    last += 1
    if best < 0:
        return start, NOWHERE
    reached, stop_gap = best_point, FARTHEST
    node = best if to_last_wall and not sliding else -1
    while node >= 0:
        stop, gap = _stop_at_wall(mesh, polygons[node], start, end)
        if gap < stop_gap:
            reached, stop_gap = stop, gap
        node = parents[node]
    return reached, polygons[best]


@njit(cache=True)
def _stop_at_wall(mesh, polygon, start, end):
    """Where a move meets a polygon's walls, nearest to its end, and the squared distance to it.

    An edge to a polygon of the same tile is no wall, even if that polygon is not walkable.
    """
    found = np.empty(_MOST_NEIGHBOURS, dtype=np.int32)
    count = mesh.corner_count[polygon]
    reached, least = start, FARTHEST
    for edge in range(count):
        if mesh.neighbours[polygon, edge] >= 0 or _neighbours(mesh, polygon, edge, found) > 0:
            continue
        a, b = corner(mesh, polygon, edge), corner(mesh, polygon, (edge + 1) % count)
        gap, stop = _stop_at(a, b, start, end, True)
        if gap < least:
            reached, least = stop, gap
    return reached, least


@njit(cache=True)
def try_step(mesh, islands, start, end, sliding, to_last_wall):
    """The end of a straight move on the mesh, as habitat-sim's ``PathFinder::tryStep``.

    It is the start if start or end is off the mesh or they lie on different islands.
    """
    polygon, point = nearest(mesh, start, islands, ANY_ISLAND)
    end_polygon, _ = nearest(mesh, end, islands, ANY_ISLAND)
    if polygon == NOWHERE or end_polygon == NOWHERE or islands[polygon] != islands[end_polygon]:
        return start
    reached, last = move(mesh, polygon, point, end, sliding, to_last_wall)
    if last == NOWHERE:
        return start
    over, height = height_on(mesh, last, reached)
    if over:
        reached = (reached[0], height, reached[2])
    # Where two islands touch, the point may be found on the other. habitat-sim moves it inwards.
    beside, _ = nearest(mesh, reached, islands, ANY_ISLAND)
    if beside == NOWHERE or islands[beside] != islands[polygon]:
        return _nudged(mesh, last, reached)
    return reached


@njit(cache=True)
def _nudged(mesh, polygon, p):
    """A point moved a little towards the middle of a polygon."""
    count = mesh.corner_count[polygon]
    x, y, z = ZERO, ZERO, ZERO
    for i in range(count):
        a = corner(mesh, polygon, i)
        x, y, z = x + a[0], y + a[1], z + a[2]
    corners = np.float32(count)
    middle = (x / corners, y / corners, z / corners)
    length = distance(p, middle)
    return between(p, middle, _NUDGE / length) if length > ZERO else p
