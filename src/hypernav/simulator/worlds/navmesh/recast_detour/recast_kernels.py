"""Loops of Recast over voxels and detail vertices (numba kernels).

Triangles as solid spans in columns of voxels (``RecastRasterization.cpp``), distances in the open
space (``calculateDistanceField``), regions that begin (``floodRegion``), heights that grow over a
patch of columns (``getHeightData``), and edges of Delaunay triangulations (``completeFacet``).

Detail vertices are rows of x, y, z in metres, single precision; distances are in the plane of x and
z. An edge of a triangulation is a row of both ends, the face on its left and the face on its right.
"""

import math

import numpy as np
from numba import njit

_ZERO, _ONE, _TWO = np.float32(0.0), np.float32(1.0), np.float32(2.0)
_HIGHEST = 8191
"""Voxels above each other that a span can count."""
# A function is compiled for every literal number that it is called with, but once for these.
_X, _Y, _Z = np.int64(0), np.int64(1), np.int64(2)
_REST, _ROW, _LEFT, _PART = np.int64(0), np.int64(1), np.int64(2), np.int64(3)
_TRIANGLE = np.int64(3)
_LOW, _HIGH, _WALKABLE, _NEXT = 0, 1, 2, 3
_STRAIGHT, _DIAGONAL = 2, 3
OPEN = -1
"""A face that is not known yet."""
HULL = -2
"""No face: the edge belongs to the hull."""
_NONE = -1
_LEAST_CROSS = np.float32(1e-5)
_TOLERANCE = np.float32(0.001)


@njit(cache=True, nogil=True, error_model="numpy")
def fill(vertices, triangles, walkable, i, first, spans, used, free, parts, bounds, cells, climb):
    """Fill the spans of triangles, as long as there is room for them.

    Args:
        vertices: Corners, Habitat's frame, metres, single precision.
        triangles: Vertex numbers.
        walkable: 1 where a robot can stand on a triangle, as far as its slope tells.
        i: First triangle.
        first: Lowest span of the column at z and x; -1 where there is none.
        spans: Lowest voxel, voxel above, 1 where a robot can stand, and the span above it.
        used: Spans that have been used.
        free: First of those that are free again; each names the following one.
        parts: Room for four polygons of up to 12 corners.
        bounds: Lowest and highest corner of the voxels, metres.
        cells: Side of a column and height of a voxel, metres.
        climb: Voxels that the robot climbs; tops no farther apart count as one surface.

    Returns:
        The first triangle left, the new values of `used` and `free`, and how many spans that
        triangle may need.
    """
    low_x, low_y, low_z = bounds[0, 0], bounds[0, 1], bounds[0, 2]
    top = bounds[1, 1] - low_y
    cell, per_cell, per_height = cells[0], _ONE / cells[0], _ONE / cells[1]
    depth, width = first.shape
    rest, row, left, part = _REST, _ROW, _LEFT, _PART
    while i < len(triangles):
        for k in range(3):
            for axis in range(3):
                parts[rest, k, axis] = vertices[triangles[i, k], axis]
        least, most = _extent(parts, rest, _TRIANGLE, _X)
        needed = int((most - least) * per_cell) + 3
        least, most = _extent(parts, rest, _TRIANGLE, _Z)
        z = min(max(int((least - low_z) * per_cell), 0), depth - 1)
        z_last = min(max(int((most - low_z) * per_cell), 0), depth - 1)
        needed *= z_last - z + 1
        if used + needed > len(spans):
            return i, used, free, needed
        rest_count = _TRIANGLE
        while z <= z_last:
            border = low_z + np.float32(z) * cell + cell
            row_count, rest_count = _split(parts, rest, rest_count, row, left, border, _Z)
            rest, left = left, rest
            least, most = _extent(parts, row, row_count, _X)
            x = max(int((least - low_x) * per_cell), 0)
            x_last = min(max(int((most - low_x) * per_cell), 0), width - 1)
            while row_count >= 3 and x <= x_last:
                border = low_x + np.float32(x) * cell + cell
                count, row_count = _split(parts, row, row_count, part, left, border, _X)
                row, left = left, row
                least, most = _extent(parts, part, count, _Y)
                low, high = least - low_y, most - low_y
                if count >= 3 and high >= _ZERO and low <= top:
                    new = free
                    if new >= 0:
                        free = spans[new, _NEXT]
                    else:
                        new = used
                        used += 1
                    bottom = min(math.floor(max(low, _ZERO) * per_height), _HIGHEST)
                    above = max(math.ceil(min(high, top) * per_height), bottom + 1)
                    spans[new, _LOW], spans[new, _HIGH] = bottom, min(above, _HIGHEST)
                    spans[new, _WALKABLE] = walkable[i]
                    free = _insert(first, spans, z, x, new, free, climb)
                x += 1
            z += 1
        i += 1
    return i, used, free, 0


@njit(cache=True, nogil=True)
def _extent(parts, part, count, axis):
    low = high = parts[part, 0, axis]
    for k in range(1, count):
        low, high = min(low, parts[part, k, axis]), max(high, parts[part, k, axis])
    return low, high


@njit(cache=True, nogil=True, error_model="numpy")
def _split(parts, part, count, near, far, border, axis):
    """Cut a convex polygon; a corner on the border belongs to both parts. Returns their sizes."""
    nears, fars = 0, 0
    b = count - 1
    gap_b = border - parts[part, b, axis]
    for a in range(count):
        gap_a = border - parts[part, a, axis]
        cut = (gap_a >= _ZERO) != (gap_b >= _ZERO)
        if cut:
            s = gap_b / (gap_b - gap_a)
            for k in range(3):
                crossing = parts[part, b, k] + (parts[part, a, k] - parts[part, b, k]) * s
                parts[near, nears, k], parts[far, fars, k] = crossing, crossing
            nears, fars = nears + 1, fars + 1
        # A corner on the border beside a cut is the cut itself.
        if gap_a > _ZERO or (gap_a == _ZERO and not cut):
            for k in range(3):
                parts[near, nears, k] = parts[part, a, k]
            nears += 1
        if gap_a < _ZERO or (gap_a == _ZERO and not cut):
            for k in range(3):
                parts[far, fars, k] = parts[part, a, k]
            fars += 1
        b, gap_b = a, gap_a
    return nears, fars


@njit(cache=True, nogil=True)
def _insert(first, spans, z, x, new, free, climb):
    """Put a span into its column, joined with those that it touches; returns the free spans."""
    before, span = -1, first[z, x]
    while span >= 0 and spans[span, _LOW] <= spans[new, _HIGH]:
        after = spans[span, _NEXT]
        if spans[span, _HIGH] < spans[new, _LOW]:
            before = span
        else:
            spans[new, _LOW] = min(spans[new, _LOW], spans[span, _LOW])
            spans[new, _HIGH] = max(spans[new, _HIGH], spans[span, _HIGH])
            if spans[new, _HIGH] - spans[span, _HIGH] <= climb:
                spans[new, _WALKABLE] = max(spans[new, _WALKABLE], spans[span, _WALKABLE])
            if before >= 0:
                spans[before, _NEXT] = after
            else:
                first[z, x] = after
            spans[span, _NEXT] = free
            free = span
        span = after
    spans[new, _NEXT] = span
    if before >= 0:
        spans[before, _NEXT] = new
    else:
        first[z, x] = new
    return free


@njit(cache=True, nogil=True)
def spread(neighbours, distance):
    """Lower every distance to those of neighbours and of diagonal ones, there and back again.

    Args:
        neighbours: Span in each of the four directions; negative where there is none.
        distance: Distances, in half columns; written anew.
    """
    count = len(distance)
    for sweep in range(2):
        for n in range(count):
            i = count - 1 - n if sweep else n
            own = distance[i]
            for k in range(2):
                direction = (2 * sweep + 3 * k) & 3
                beside = neighbours[i, direction]
                if beside >= 0:
                    own = min(own, distance[beside] + _STRAIGHT)
                    corner = neighbours[beside, (direction + 3) & 3]
                    if corner >= 0:
                        own = min(own, distance[corner] + _DIAGONAL)
            distance[i] = own


@njit(cache=True, nogil=True)
def flood(neighbours, walkable, distance, regions, gaps, seeds, least, following, stack):
    """Begin a region at every seed that is still free and not beside another region.

    Args:
        neighbours: Span in each of the four directions; negative where there is none.
        walkable: Whether the middle of the robot may be on a span.
        distance: Distance of every span to a border.
        regions: Region of every span, 0 for none; written.
        gaps: Distance of every span to where its region began; written.
        seeds: Spans to begin at, in order.
        least: Spans nearer to a border stay free.
        following: Number of the next region.
        stack: Room for as many spans as there are.

    Returns:
        Number of the next region.
    """
    for seed in seeds:
        if regions[seed] != 0:
            continue
        regions[seed], gaps[seed] = following, 0
        stack[0] = seed
        depth, count = 1, 0
        while depth > 0:
            depth -= 1
            i = stack[depth]
            alone = True
            for direction in range(4):
                beside = neighbours[i, direction]
                if beside < 0 or not walkable[beside]:
                    continue
                corner = neighbours[beside, (direction + 1) & 3]
                if regions[beside] != 0 and regions[beside] != following:
                    alone = False
                if corner >= 0 and regions[corner] != 0 and regions[corner] != following:
                    alone = False
            if not alone:
                regions[i] = 0
                continue
            count += 1
            for direction in range(4):
                beside = neighbours[i, direction]
                if beside < 0 or not walkable[beside]:
                    continue
                if distance[beside] >= least and regions[beside] == 0:
                    regions[beside], gaps[beside] = following, 0
                    stack[depth] = beside
                    depth += 1
        if count > 0:
            following += 1
    return following


@njit(cache=True, nogil=True)
def grow(neighbours, x, z, floor, patch, x_low, z_low, unset, queue, end):
    """Carry heights on to what can be walked to from spans whose heights are known.

    Args:
        neighbours: Span in each of the four directions; negative where there is none.
        x: Column of every span along x.
        z: Column of every span along z.
        floor: Height of every span.
        patch: Heights by column z and column x; written.
        x_low: Column along x of the first entry.
        z_low: Column along z of the first entry.
        unset: What stands where no height is known.
        queue: The spans to begin with, and room for as many as the patch has entries.
        end: Number of the first.
    """
    head = 0
    while head < end:
        i = queue[head]
        head += 1
        for direction in range(4):
            beside = neighbours[i, direction]
            if beside < 0:
                continue
            row, column = z[beside] - z_low, x[beside] - x_low
            inside = 0 <= row < patch.shape[0] and 0 <= column < patch.shape[1]
            if inside and patch[row, column] == unset:
                patch[row, column] = floor[beside]
                queue[end] = beside
                end += 1


@njit(cache=True, nogil=True, error_model="numpy")
def complete(vertices, edges, count):
    """Find the triangles on the open sides of all edges, those of new edges among them.

    Args:
        vertices: The vertices.
        edges: Edges of the hull, and room for others; written.
        count: Number of the edges of the hull.

    Returns:
        The number of edges and of faces.
    """
    faces, edge = 0, 0
    while edge < count:
        for side in range(2, 4):
            if edges[edge, side] != OPEN:
                continue
            # The open side lies on the left, seen from s to t.
            s, t = edges[edge, side - 2], edges[edge, 3 - side]
            best = _third(vertices, edges, count, s, t)
            if best == _NONE:
                edges[edge, side] = HULL
                continue
            edges[edge, side] = faces
            for k in range(2):
                a, b = (t, best) if k else (best, s)
                count = _enter(edges, count, a, b, faces)
            faces += 1
        edge += 1
    return count, faces


@njit(cache=True, nogil=True)
def _enter(edges, count, a, b, face):
    """Set the face left of an edge, unless that is known; returns the number of edges."""
    for k in range(count):
        for side in range(2, 4):
            if edges[k, side - 2] == a and edges[k, 3 - side] == b:
                if edges[k, side] == OPEN:
                    edges[k, side] = face
                return count
    if count < len(edges):
        edges[count, 0], edges[count, 1], edges[count, 2], edges[count, 3] = a, b, face, OPEN
        count += 1
    return count


@njit(cache=True, nogil=True, error_model="numpy")
def _third(vertices, edges, count, s, t):
    """The vertex left of an edge whose circle with the edge holds no other; none on the hull."""
    best = _NONE
    x, z, radius = _ZERO, _ZERO, -_ONE
    ax, az = vertices[s, 0], vertices[s, 2]
    bx, bz = vertices[t, 0] - ax, vertices[t, 2] - az
    for u in range(len(vertices)):
        cx, cz = vertices[u, 0] - ax, vertices[u, 2] - az
        cross = bx * cz - bz * cx
        if u in (s, t) or not cross > _LEAST_CROSS:
            continue
        if radius >= _ZERO:
            dx, dz = vertices[u, 0] - x, vertices[u, 2] - z
            gap = math.sqrt(dx * dx + dz * dz)
            if gap > radius * (_ONE + _TOLERANCE):
                continue
            if not gap < radius * (_ONE - _TOLERANCE) and (
                _overlaps(vertices, edges, count, s, u) or _overlaps(vertices, edges, count, t, u)
            ):
                continue
        best = u
        bb, cc = bx * bx + bz * bz, cx * cx + cz * cz
        x = (bb * cz + cc * (_ZERO - bz)) / (_TWO * cross)
        z = (bb * (_ZERO - cx) + cc * bx) / (_TWO * cross)
        x, z, radius = x + ax, z + az, math.sqrt(x * x + z * z)
    return best


@njit(cache=True, nogil=True)
def _overlaps(vertices, edges, count, a, b):
    """Whether the segment between two vertices crosses an edge."""
    for k in range(count):
        c, d = edges[k, 0], edges[k, 1]
        if c in (a, b) or d in (a, b):
            continue
        a1, a2 = _cross(vertices, c, d, b), _cross(vertices, c, d, a)
        if a1 * a2 < _ZERO:
            a3 = _cross(vertices, a, b, c)
            if a3 * (a3 + a2 - a1) < _ZERO:
                return True
    return False


@njit(cache=True, nogil=True)
def _cross(vertices, a, b, c):
    ax, az = vertices[a, 0], vertices[a, 2]
    bx, bz = vertices[b, 0] - ax, vertices[b, 2] - az
    return bx * (vertices[c, 2] - az) - bz * (vertices[c, 0] - ax)
