"""Detail meshes: triangles of polygons that follow the voxels' heights (numba kernels).

As ``rcBuildPolyMeshDetail``. Points are in metres from the lowest corner, single precision.
"""

import math

import numpy as np
from numba import njit

from hypernav.worlds.navmesh.recast.delaunay_kernels import delaunay, triangles_of_hull
from hypernav.worlds.navmesh.recast.height_kernels import height_at, height_patch

_MOST_VERTICES = 127
_MOST_TRIANGLES = 255
_MOST_EDGE_SAMPLES = 31
_NONE = -1
_ZERO, _HALF, _ONE, _TWO = np.float32(0.0), np.float32(0.5), np.float32(1.0), np.float32(2.0)
_SAME = np.float32(1e-6)
_EDGE_GAP_SQUARED = np.float32(0.001) * np.float32(0.001)
_INSIDE = np.float32(1e-4)
_FARTHEST = np.float32(np.finfo(np.float32).max)
_JITTER = np.float32(0.1)
_JITTER_RANGE = np.float32(65535.0)
_JITTER_X, _JITTER_Z = 0x8DA6B343, 0xD8163841


@njit(cache=True, nogil=True)
def detail_meshes(space, regions, vertices, polygons, owner, origin, cell, height, spacing, error):
    """The detail meshes of all polygons.

    Args:
        space: Open space, eroded.
        regions: Region of every span.
        vertices: Corners of polygons (column x, height in voxels, column z).
        polygons: Vertices of every polygon, padded with -1.
        owner: Region of every polygon.
        origin: Lowest corner, Habitat's frame, metres.
        cell: Side of a column, metres.
        height: Height of a voxel, metres.
        spacing: Distance of samples, metres.
        error: Largest accepted error of a height, metres; and columns around a sample in which a
            height is searched.

    Returns:
        Vertices of all detail meshes in Habitat's frame, those of the polygon first of each; first
        vertex of every mesh and the number of vertices; triangles with the flags of their edges;
        first triangle of every mesh and the number of triangles.
    """
    most_error, reach = error
    points = np.empty((256, 3), dtype=np.float32)
    triangles = np.empty((256, 4), dtype=np.uint8)
    point_start = np.zeros(len(polygons) + 1, dtype=np.int64)
    triangle_start = np.zeros(len(polygons) + 1, dtype=np.int64)
    scale = np.array([cell, height, cell], dtype=np.float32)
    for i in range(len(polygons)):
        corners = polygons[i][polygons[i] != _NONE]
        outline = vertices[corners].astype(np.float32) * scale
        patch, x_low, z_low = height_patch(space, regions, owner[i], vertices, corners)
        heights = (patch, x_low, z_low, _ONE / cell, height, reach)
        mesh, faces = _detail(outline, heights, cell, spacing, most_error)
        first, last = point_start[i], point_start[i] + len(mesh)
        while last > len(points):
            points = np.concatenate((points, np.empty_like(points)))
        for k in range(len(mesh)):
            points[first + k, 0] = mesh[k, 0] + origin[0]
            points[first + k, 1] = mesh[k, 1] + (origin[1] + height)
            points[first + k, 2] = mesh[k, 2] + origin[2]
        begin, end = triangle_start[i], triangle_start[i] + len(faces)
        while end > len(triangles):
            triangles = np.concatenate((triangles, np.empty_like(triangles)))
        for k in range(len(faces)):
            for j in range(3):
                triangles[begin + k, j] = faces[k, j]
            triangles[begin + k, 3] = _flags(outline + origin, points[first:last], faces[k])
        point_start[i + 1], triangle_start[i + 1] = last, end
    return (
        points[: point_start[-1]].copy(),
        point_start,
        triangles[: triangle_start[-1]].copy(),
        triangle_start,
    )


@njit(cache=True, nogil=True)
def _detail(outline, heights, cell, spacing, most_error):
    """Vertices and triangles of one detail mesh."""
    points = np.empty((_MOST_VERTICES + 1, 3), dtype=np.float32)
    hull = np.empty(_MOST_VERTICES + 1, dtype=np.int64)
    corners = len(outline)
    points[:corners] = outline
    count, hulled = corners, 0
    for i in range(corners):
        count, hulled = _sampled_side(
            outline, (i - 1) % corners, i, points, count, hull, hulled, heights, spacing, most_error
        )
    hull = hull[:hulled]
    triangles = triangles_of_hull(points, hull, corners)
    if not _extent(outline) < spacing * _TWO:
        samples = _samples(outline, heights, spacing)
        height = heights[4]
        for _ in range(len(samples)):
            if count >= _MOST_VERTICES:
                break
            worst = _worst_sample(samples, points, triangles, cell, height, spacing, most_error)
            if worst == _NONE:
                break
            points[count] = _sample(samples, worst, cell, height, spacing)
            samples[worst, 1] = _NONE
            count += 1
            triangles = delaunay(points[:count], hull)
    return points[:count], triangles[:_MOST_TRIANGLES]


@njit(cache=True, nogil=True, error_model="numpy")
def _sampled_side(outline, first, last, points, count, hull, hulled, heights, spacing, most_error):
    """Add vertices along a side where its heights leave the straight line.

    Returns:
        The number of vertices, and of those on the hull.
    """
    a, b = outline[first], outline[last]
    # Polygons on both sides must get the same result.
    swapped = a[2] > b[2] if abs(a[0] - b[0]) < _SAME else a[0] > b[0]
    if swapped:
        a, b = b, a
    dx, dy, dz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    steps = 1 + math.floor(math.sqrt(dx * dx + dz * dz) / spacing)
    steps = min(steps, _MOST_EDGE_SAMPLES)
    if count + steps >= _MOST_VERTICES:
        steps = _MOST_VERTICES - 1 - count
    patch, x_low, z_low, per_cell, height, reach = heights
    samples = np.empty((_MOST_EDGE_SAMPLES + 1, 3), dtype=np.float32)
    for k in range(steps + 1):
        u = np.float32(k) / np.float32(steps)
        x, y, z = a[0] + dx * u, a[1] + dy * u, a[2] + dz * u
        level = height_at(patch, x_low, z_low, x, y, z, per_cell, height, reach)
        samples[k, 0], samples[k, 1], samples[k, 2] = x, np.float32(level) * height, z
    kept = _kept_samples(samples, steps, most_error)
    hull[hulled] = first
    hulled += 1
    inner = kept[1:-1]
    for k in range(len(inner)):
        points[count] = samples[inner[len(inner) - 1 - k] if swapped else inner[k]]
        hull[hulled] = count
        count, hulled = count + 1, hulled + 1
    return count, hulled


@njit(cache=True, nogil=True)
def _kept_samples(samples, steps, most_error):
    """The samples between which a side is straight enough."""
    kept = np.empty(_MOST_EDGE_SAMPLES + 1, dtype=np.int64)
    kept[0], kept[1] = 0, steps
    count, k = 2, 0
    while k < count - 1:
        a, b = kept[k], kept[k + 1]
        farthest, gap = _NONE, _ZERO
        for m in range(a + 1, b):
            distance = _to_segment(samples[m], samples[a], samples[b])
            if distance > gap:
                farthest, gap = m, distance
        if farthest != _NONE and gap > most_error * most_error:
            for m in range(count, k, -1):
                kept[m] = kept[m - 1]
            kept[k + 1] = farthest
            count += 1
        else:
            k += 1
    return kept[:count]


@njit(cache=True, nogil=True)
def _to_segment(p, a, b):
    """Squared distance in space from a point to a segment."""
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    dx, dy, dz = p[0] - a[0], p[1] - a[1], p[2] - a[2]
    length = ux * ux + uy * uy + uz * uz
    t = ux * dx + uy * dy + uz * dz
    if length > _ZERO:
        t = t / length
    t = min(max(t, _ZERO), _ONE)
    dx, dy, dz = a[0] + t * ux - p[0], a[1] + t * uy - p[1], a[2] + t * uz - p[2]
    return dx * dx + dy * dy + dz * dz


@njit(cache=True, nogil=True)
def _to_segment_in_plane(x, z, a, b):
    """Squared distance in the plane from a point to a segment."""
    ux, uz = b[0] - a[0], b[2] - a[2]
    dx, dz = x - a[0], z - a[2]
    length = ux * ux + uz * uz
    t = ux * dx + uz * dz
    if length > _ZERO:
        t = t / length
    t = min(max(t, _ZERO), _ONE)
    dx, dz = a[0] + t * ux - x, a[2] + t * uz - z
    return dx * dx + dz * dz


@njit(cache=True, nogil=True)
def _extent(outline):
    """The smallest width of a polygon."""
    least = _FARTHEST
    count = len(outline)
    for i in range(count):
        after = (i + 1) % count
        width = _ZERO
        for j in range(count):
            if j != i and j != after:
                gap = _to_segment_in_plane(outline[j, 0], outline[j, 2], outline[i], outline[after])
                width = max(width, gap)
        least = min(least, width)
    return math.sqrt(least)


@njit(cache=True, nogil=True)
def _samples(outline, heights, spacing):
    """Samples on a grid within a polygon: row x, height in voxels, row z."""
    patch, x_low, z_low, per_cell, height, reach = heights
    low_x, high_x = outline[:, 0].min(), outline[:, 0].max()
    low_z, high_z = outline[:, 2].min(), outline[:, 2].max()
    middle = (outline[:, 1].max() + outline[:, 1].min()) * _HALF
    x_first, x_end = math.floor(low_x / spacing), math.ceil(high_x / spacing)
    z_first, z_end = math.floor(low_z / spacing), math.ceil(high_z / spacing)
    samples = np.empty((max(x_end - x_first, 0) * max(z_end - z_first, 0), 3), dtype=np.int64)
    count = 0
    for row_z in range(z_first, z_end):
        for row_x in range(x_first, x_end):
            x, z = np.float32(row_x) * spacing, np.float32(row_z) * spacing
            if _signed_gap(outline, x, z) > -spacing / _TWO:
                continue
            samples[count, 0], samples[count, 2] = row_x, row_z
            samples[count, 1] = height_at(
                patch, x_low, z_low, x, middle, z, per_cell, height, reach
            )
            count += 1
    return samples[:count]


@njit(cache=True, nogil=True, error_model="numpy")
def _signed_gap(outline, x, z):
    """Squared distance to a polygon's sides, negative within."""
    inside = False
    least = _FARTHEST
    for i in range(len(outline)):
        a, b = outline[i], outline[i - 1]
        if (a[2] > z) != (b[2] > z) and x < (b[0] - a[0]) * (z - a[2]) / (b[2] - a[2]) + a[0]:
            inside = not inside
        least = min(least, _to_segment_in_plane(x, z, b, a))
    return -least if inside else least


@njit(cache=True, nogil=True)
def _sample(samples, i, cell, height, spacing):
    """A sample's point, moved a little aside, because even grids triangulate badly."""
    x = np.float32(samples[i, 0]) * spacing + _jitter(i, _JITTER_X) * cell * _JITTER
    z = np.float32(samples[i, 2]) * spacing + _jitter(i, _JITTER_Z) * cell * _JITTER
    return np.array([x, np.float32(samples[i, 1]) * height, z], dtype=np.float32)


@njit(cache=True, nogil=True)
def _jitter(i, factor):
    return np.float32((i * factor) & 0xFFFF) / _JITTER_RANGE * _TWO - _ONE


@njit(cache=True, nogil=True)
def _worst_sample(samples, points, triangles, cell, height, spacing, most_error):
    """The sample whose height differs most from the triangles', if by too much."""
    worst, gap = _NONE, _ZERO
    for i in range(len(samples)):
        if samples[i, 1] == _NONE:
            continue
        point = _sample(samples, i, cell, height, spacing)
        least = _FARTHEST
        for k in range(len(triangles)):
            a, b, c = points[triangles[k, 0]], points[triangles[k, 1]], points[triangles[k, 2]]
            least = min(least, _height_gap(point, a, b, c))
        if least != _FARTHEST and least > gap:
            worst, gap = i, least
    return worst if gap > most_error else _NONE


@njit(cache=True, nogil=True, error_model="numpy")
def _height_gap(p, a, b, c):
    """Distance in height of a point to a triangle; the largest number beside the triangle."""
    ux, uy, uz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    vx, vy, vz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    wx, wz = p[0] - a[0], p[2] - a[2]
    uu, uv, uw = ux * ux + uz * uz, ux * vx + uz * vz, ux * wx + uz * wz
    vv, vw = vx * vx + vz * vz, vx * wx + vz * wz
    inverse = _ONE / (uu * vv - uv * uv)
    s = (vv * uw - uv * vw) * inverse
    t = (uu * vw - uv * uw) * inverse
    if s >= -_INSIDE and t >= -_INSIDE and s + t <= _ONE + _INSIDE:
        return abs(a[1] + uy * s + vy * t - p[1])
    return _FARTHEST


@njit(cache=True, nogil=True)
def _flags(outline, points, face):
    """Two bits for each edge; the lower one says that it lies on the polygon's boundary."""
    flags = 0
    for edge in range(3):
        a, b = points[face[edge]], points[face[(edge + 1) % 3]]
        for i in range(len(outline)):
            p, q = outline[i - 1], outline[i]
            if (
                _to_segment_in_plane(a[0], a[2], p, q) < _EDGE_GAP_SQUARED
                and _to_segment_in_plane(b[0], b[2], p, q) < _EDGE_GAP_SQUARED
            ):
                flags |= 1 << (2 * edge)
                break
    return flags
