"""Detour's plane geometry, its heap, islands, and the nearest point of a mesh (numba kernels).

All arithmetic is in single precision and in Detour's order, so that ties between polygons are
decided equally; for the same reason the heap has the order of ``dtNodeQueue``. Points are tuples
``(x, y, z)``, y up; "plane" means x and z.

The nearest polygon and point are those of Detour's ``dtNavMesh::getPolyHeight``,
``closestPointOnPoly`` and ``dtNavMeshQuery::findNearestPoly``, with habitat-sim's search box.
"""

import math

import numpy as np
from numba import njit

ZERO = np.float32(0.0)
HALF = np.float32(0.5)
ONE = np.float32(1.0)
FARTHEST = np.float32(np.finfo(np.float32).max)
_SAME_SQUARED = np.float32((1.0 / 16384.0) ** 2)
_PARALLEL = np.float32(1e-6)
NOWHERE = -1
ANY_ISLAND = np.int64(NOWHERE)
"""Searches all islands. Numba would compile `nearest` once more for a constant of Python."""
_REACH = (np.float32(2.0), np.float32(4.0), np.float32(2.0))
"""Half the sides of habitat-sim's search box, metres."""
_ON_BOUNDARY = (np.uint8(1), np.uint8(4), np.uint8(16))
"""Flags of a detail triangle's edges 0-1, 1-2 and 2-0."""
_FINEST = np.float32(65535.0)


@njit(cache=True)
def vertex(mesh, i):
    """A vertex as a point."""
    return mesh.vertices[i, 0], mesh.vertices[i, 1], mesh.vertices[i, 2]


@njit(cache=True)
def corner(mesh, polygon, i):
    """A corner of a polygon as a point."""
    return vertex(mesh, mesh.corners[polygon, i])


@njit(cache=True)
def between(a, b, t):
    """The point at a fraction of the straight line from a to b."""
    return (a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t)


@njit(cache=True)
def squared_distance(a, b):
    """Squared distance in space."""
    dx, dy, dz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    return dx * dx + dy * dy + dz * dz


@njit(cache=True)
def distance(a, b):
    """Distance in space."""
    return math.sqrt(squared_distance(a, b))


@njit(cache=True)
def is_same(a, b):
    """Whether two points are closer than a sixteenth of a millimetre."""
    return squared_distance(a, b) < _SAME_SQUARED


@njit(cache=True)
def signed_area(a, b, c):
    """Twice the area of a triangle in the plane; its sign tells the side of c."""
    return (c[0] - a[0]) * (b[2] - a[2]) - (b[0] - a[0]) * (c[2] - a[2])


@njit(cache=True)
def to_segment(p, a, b):
    """Squared distance from p to the segment a-b in the plane, and where on it, 0 to 1."""
    abx, abz = b[0] - a[0], b[2] - a[2]
    dx, dz = p[0] - a[0], p[2] - a[2]
    length = abx * abx + abz * abz
    t = abx * dx + abz * dz
    if length > ZERO:
        t = t / length
    t = min(max(t, ZERO), ONE)
    dx = a[0] + t * abx - p[0]
    dz = a[2] + t * abz - p[2]
    return dx * dx + dz * dz, t


@njit(cache=True)
def crossing(a, b, c, d):
    """Whether the lines a-b and c-d cross in the plane, and where on each: 0 to 1 is within."""
    ux, uz = b[0] - a[0], b[2] - a[2]
    vx, vz = d[0] - c[0], d[2] - c[2]
    wx, wz = a[0] - c[0], a[2] - c[2]
    cross = ux * vz - uz * vx
    if abs(cross) < _PARALLEL:
        return False, ZERO, ZERO
    return True, (vx * wz - vz * wx) / cross, (ux * wz - uz * wx) / cross


@njit(cache=True)
def is_over(mesh, polygon, p):
    """Whether a point lies over or under a polygon."""
    inside = False
    count = mesh.corner_count[polygon]
    b = corner(mesh, polygon, count - 1)
    for i in range(count):
        a = corner(mesh, polygon, i)
        if (a[2] > p[2]) != (b[2] > p[2]) and p[0] < (b[0] - a[0]) * (p[2] - a[2]) / (
            b[2] - a[2]
        ) + a[0]:
            inside = not inside
        b = a
    return inside


@njit(cache=True)
def height_in_triangle(p, a, b, c):
    """Whether a point lies over or under a triangle, and the triangle's height there."""
    v0x, v0y, v0z = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    v1x, v1y, v1z = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    v2x, v2z = p[0] - a[0], p[2] - a[2]
    area = v0x * v1z - v0z * v1x
    if abs(area) < _PARALLEL:
        return False, ZERO
    u = v1z * v2x - v1x * v2z
    v = v0x * v2z - v0z * v2x
    if area < ZERO:
        area, u, v = -area, -u, -v
    if u >= ZERO and v >= ZERO and u + v <= area:
        return True, a[1] + (v0y * u + v1y * v) / area
    return False, ZERO


@njit(cache=True)
def closest_on_boundary(mesh, polygon, p):
    """The point itself if it lies over a polygon, else the closest one on the polygon's edges."""
    if is_over(mesh, polygon, p):
        return p
    count = mesh.corner_count[polygon]
    nearest = FARTHEST
    closest = p
    for i in range(count):
        a, b = corner(mesh, polygon, i), corner(mesh, polygon, (i + 1) % count)
        gap, t = to_segment(p, a, b)
        if gap < nearest:
            nearest = gap
            closest = between(a, b, t)
    return closest


@njit(cache=True)
def push(heap, size, node, total):
    """Add a node to a heap; returns its new size."""
    _rise(heap, size, node, total)
    return size + 1


@njit(cache=True)
def pop(heap, size, total):
    """Take the node with the least total from a heap; returns it and the new size."""
    least, last = heap[0], heap[size - 1]
    size -= 1
    i, child = 0, 1
    while child < size:
        if child + 1 < size and total[heap[child]] > total[heap[child + 1]]:
            child += 1
        heap[i] = heap[child]
        i, child = child, 2 * child + 1
    _rise(heap, i, last, total)
    return least, size


@njit(cache=True)
def lower(heap, size, node, total):
    """Move a node of a heap up after its total was lowered."""
    for i in range(size):
        if heap[i] == node:
            _rise(heap, i, node, total)
            return


@njit(cache=True)
def _rise(heap, i, node, total):
    parent = (i - 1) // 2
    while i > 0 and total[heap[parent]] > total[node]:
        heap[i] = heap[parent]
        i, parent = parent, (parent - 1) // 2
    heap[i] = node


@njit(cache=True)
def label_islands(mesh):
    """Island of every polygon; an island connects walkable polygons."""
    count = len(mesh.corner_count)
    labels = np.full(count, -1, dtype=np.int32)
    waiting = np.empty(count, dtype=np.int32)
    islands = 0
    for seed in range(count):
        if labels[seed] >= 0:
            continue
        labels[seed] = islands
        waiting[0] = seed
        depth = 1
        while depth > 0:
            depth -= 1
            polygon = waiting[depth]
            for link in range(mesh.link_start[polygon], mesh.link_start[polygon + 1]):
                neighbour = mesh.link_polygon[link]
                if labels[neighbour] < 0 and mesh.walkable[neighbour]:
                    labels[neighbour] = islands
                    waiting[depth] = neighbour
                    depth += 1
        islands += 1
    return labels


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
