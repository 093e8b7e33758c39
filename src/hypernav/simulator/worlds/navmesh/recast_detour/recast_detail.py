"""Detail meshes: triangles of polygons that follow the voxels' heights.

As ``rcBuildPolyMeshDetail`` of ``RecastMeshDetail.cpp``. Points are in metres from the lowest
corner, single precision.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float32, Int32, Int64, UInt8

from hypernav.simulator.worlds.navmesh.recast_detour.recast_kernels import (
    HULL,
    OPEN,
    complete,
    grow,
)
from hypernav.simulator.worlds.navmesh.recast_detour.recast_polygons import Polygons
from hypernav.simulator.worlds.navmesh.recast_detour.recast_voxels import NOTHING, OpenSpace

Point = Float32[np.ndarray, " 3"]
Points = Float32[np.ndarray, "... 3"]
Gaps = Float32[np.ndarray, "..."]
_ZERO, _HALF = np.float32(0.0), np.float32(0.5)
_ONE, _TWO = np.float32(1.0), np.float32(2.0)
_NONE = -1
UNSET = 0xFFFF
_AROUND = ((0, 0), (-1, -1), (0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0))
_SHIFT = np.float32(0.01)
_INSIDE = np.float32(1e-4)
_JITTER = np.float32(0.1)
_JITTER_RANGE = np.float32(65535.0)
_JITTER_X, _JITTER_Z = 0x8DA6B343, 0xD8163841
_MOST_VERTICES = 127
_MOST_TRIANGLES = 255
_MOST_EDGE_SAMPLES = 31
_SAME = np.float32(1e-6)
_EDGE_GAP_SQUARED = np.float32(0.001) * np.float32(0.001)


def squared_to_segment(p: Points, a: Point, b: Point) -> Gaps:
    """Squared distances in space from points to one segment."""
    u, d = b - a, p - a
    length = u[0] * u[0] + u[1] * u[1] + u[2] * u[2]
    t = u[0] * d[:, 0] + u[1] * d[:, 1] + u[2] * d[:, 2]
    if length > _ZERO:
        t = t / length
    gap = a + np.clip(t, _ZERO, _ONE)[:, None] * u - p
    x, y, z = gap.T
    return x * x + y * y + z * z


def squared_to_sides(points: Points, outline: Points) -> Gaps:
    """Squared distances in the plane from points to the sides of a polygon.

    The k-th side runs from the corner before the k-th one to it.
    """
    b = outline
    a = np.roll(outline, 1, axis=0)
    ux, uz = b[:, 0] - a[:, 0], b[:, 2] - a[:, 2]
    x, z = points[:, None, 0], points[:, None, 2]
    dx, dz = x - a[:, 0], z - a[:, 2]
    length = ux * ux + uz * uz
    t = ux * dx + uz * dz
    t = np.clip(t / np.where(length > _ZERO, length, _ONE), _ZERO, _ONE)
    dx, dz = a[:, 0] + t * ux - x, a[:, 2] + t * uz - z
    return dx * dx + dz * dz


def is_inside(points: Points, outline: Points) -> Bool[np.ndarray, "..."]:
    """Whether points lie within a polygon, in the plane."""
    a, b = outline, np.roll(outline, 1, axis=0)
    x, z = points[:, None, 0], points[:, None, 2]
    spans = (a[:, 2] > z) != (b[:, 2] > z)
    with np.errstate(divide="ignore", invalid="ignore"):
        left = x < (b[:, 0] - a[:, 0]) * (z - a[:, 2]) / (b[:, 2] - a[:, 2]) + a[:, 0]
    return (spans & left).sum(axis=1) % 2 == 1


def least_width(outline: Points) -> np.float32:
    """The least width of a convex polygon, by its sides."""
    gaps = squared_to_sides(outline, outline)
    return np.sqrt(gaps.max(axis=0).min())


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


class Sampling(NamedTuple):
    """How heights are sampled; all in single precision.

    Attributes:
        cell: Side of a column, metres.
        cell_height: Height of a voxel, metres.
        spacing: Distance of samples, metres.
        most_error: Greatest accepted error of a height, metres.
        reach: Columns around a sample in which a height is looked for.
    """

    cell: np.float32
    cell_height: np.float32
    spacing: np.float32
    most_error: np.float32
    reach: int


class Regions:
    """Regions of the open space, and which spans lie at their borders."""

    def __init__(self, space: OpenSpace, numbers: Int32[np.ndarray, " s"]) -> None:
        """Look for the borders."""
        beside = space.neighbours
        self.space, self.numbers = space, numbers
        self.at_border: Bool[np.ndarray, " s"] = (
            (beside != NOTHING) & (numbers[beside] != numbers[:, None])
        ).any(axis=1)


class Patch:
    """Heights over a polygon's box: those of its region, grown to what can be walked to from there.

    Attributes:
        heights: By column z and column x, voxels; `UNSET` where none is known.
        x_low: Column along x of the first entry.
        z_low: Column along z of the first entry.
    """

    def __init__(self, regions: Regions, region: int, points: Int64[np.ndarray, "c 3"]) -> None:
        """Find the heights."""
        space = regions.space
        self.x_low, self.z_low = (max(int(points[:, axis].min()) - 1, 0) for axis in (0, 2))
        x = np.arange(self.x_low, min(int(points[:, 0].max()) + 1, space.width))
        z = np.arange(self.z_low, min(int(points[:, 2].max()) + 1, space.depth))
        column = x + z[:, None] * space.width
        span = _first_of_region(regions, region, column)
        self.heights: Int32[np.ndarray, "z x"] = np.where(
            span == NOTHING, UNSET, space.floor[span]
        ).astype(np.int32)
        seeds = span[(span != NOTHING) & regions.at_border[span]]
        if (span == NOTHING).all():
            seeds = np.array([self._span_at_middle(space, points)])
            self.heights[space.z[seeds] - self.z_low, space.x[seeds] - self.x_low] = space.floor[
                seeds
            ]
        queue = np.empty(column.size + 1, dtype=np.int64)
        queue[: len(seeds)] = seeds
        grow(
            space.neighbours,
            space.x,
            space.z,
            space.floor,
            self.heights,
            self.x_low,
            self.z_low,
            UNSET,
            queue,
            len(seeds),
        )

    def at(self, points: Float32[np.ndarray, "n 3"], sampling: Sampling) -> Int32[np.ndarray, " n"]:
        """Heights at points, voxels; where unset, of the entries around that nearest to its own.

        Args:
            points: Points, metres from the lowest corner.
            sampling: How heights are sampled.
        """
        last = np.array(self.heights.shape) - 1
        per_cell = np.float32(1.0) / sampling.cell
        place = np.floor(points[:, [2, 0]] * per_cell + _SHIFT).astype(np.int64)
        row, column = np.clip(place - (self.z_low, self.x_low), 0, last).T
        heights = self.heights[row, column]
        for ring in range(1, sampling.reach + 1):
            unset = np.flatnonzero(heights == UNSET)
            if len(unset) == 0:
                break
            dz, dx = _ring(ring).T
            r, c = row[unset, None] + dz, column[unset, None] + dx
            inside = (r >= 0) & (r <= last[0]) & (c >= 0) & (c <= last[1])
            around = self.heights[np.clip(r, 0, last[0]), np.clip(c, 0, last[1])]
            around[~inside] = UNSET
            gap = np.abs(around.astype(np.float32) * sampling.cell_height - points[unset, 1, None])
            gap[around == UNSET] = np.inf
            nearest = gap.argmin(axis=1)
            heights[unset] = around[np.arange(len(unset)), nearest]
        return heights

    def _span_at_middle(self, space: OpenSpace, points: Int64[np.ndarray, "c 3"]) -> int:
        """The span at a polygon's middle, reached from a corner without leaving the patch."""
        middle_x, _, middle_z = (points.sum(axis=0) // len(points)).tolist()
        i = self._span_at_corner(space, points)
        stack, seen, directions = [i], set(), [0, 1, 2, 3]
        while stack:
            i = stack.pop()
            x, z = int(space.x[i]), int(space.z[i])
            if (x, z) == (middle_x, middle_z):
                break
            straight = (1 if middle_z > z else 3) if x == middle_x else 2 if middle_x > x else 0
            # The last one that is put onto the stack is the next one taken.
            directions[straight], directions[3] = directions[3], directions[straight]
            for direction in directions:
                beside = int(space.neighbours[i, direction])
                if beside == NOTHING or not self._has(space.x[beside], space.z[beside]):
                    continue
                place = int(space.x[beside]), int(space.z[beside])
                if place not in seen:
                    seen.add(place)
                    stack.append(beside)
            directions[straight], directions[3] = directions[3], directions[straight]
        return i

    def _span_at_corner(self, space: OpenSpace, points: Int64[np.ndarray, "c 3"]) -> int:
        """The span nearest in height to a corner of a polygon, at the corner or beside it."""
        nearest, gap = 0, UNSET
        for corner_x, height, corner_z in points.tolist():
            for dx, dz in _AROUND:
                x, z = corner_x + dx, corner_z + dz
                if not self._has(x, z):
                    continue
                begin, end = space.start[x + z * space.width :][:2]
                for i in range(begin, end):
                    if abs(height - int(space.floor[i])) < gap:
                        nearest, gap = i, abs(height - int(space.floor[i]))
        return nearest

    def _has(self, x: int, z: int) -> bool:
        rows, columns = self.heights.shape
        return 0 <= x - self.x_low < columns and 0 <= z - self.z_low < rows


def _first_of_region(
    regions: Regions, region: int, column: Int64[np.ndarray, "z x"]
) -> Int64[np.ndarray, "z x"]:
    """The lowest span of a region in each column."""
    start = regions.space.start
    span = np.full(column.shape, NOTHING)
    begin, end = start[column], start[column + 1]
    for layer in range(int((end - begin).max(initial=0)) - 1, -1, -1):
        i = begin + layer
        # The lowest layer is looked at last and counts.
        own = (i < end) & (regions.numbers[np.minimum(i, len(regions.numbers) - 1)] == region)
        span[own] = i[own]
    return span


@lru_cache
def _ring(ring: int) -> Int64[np.ndarray, "n 2"]:
    """Places around one, by z and x, in the order of Recast, which decides between equal ones."""
    places, dx, dz, step_x, step_z = [], ring, 1 - ring, 0, 1
    for _ in range(8 * ring):
        places.append((dz, dx))
        if (dx == ring and dz == ring) or (dx == -ring and abs(dz) == ring):
            step_x, step_z = -step_z, step_x
        dx, dz = dx + step_x, dz + step_z
    return np.array(places)


class InnerSamples:
    """Samples on a grid within a polygon that are not vertices yet."""

    def __init__(self, outline: Points, patch: Patch, sampling: Sampling) -> None:
        """Take the samples."""
        spacing, low, high = sampling.spacing, outline.min(axis=0), outline.max(axis=0)
        x, z = (
            np.arange(math.floor(low[axis] / spacing), math.ceil(high[axis] / spacing))
            for axis in (0, 2)
        )
        rows = np.stack([np.tile(x, len(z)), np.repeat(z, len(x))], axis=1)
        middle = np.full(len(rows), (high[1] + low[1]) * _HALF)
        grid = rows.astype(np.float32) * spacing
        points = np.stack([grid[:, 0], middle, grid[:, 1]], axis=1)
        least = squared_to_sides(points, outline).min(axis=1)
        within = is_inside(points, outline) & ~(-least > -spacing / _TWO)
        points = points[within]
        points[:, 1] = patch.at(points, sampling).astype(np.float32) * sampling.cell_height
        # Moved a little aside, because even grids triangulate badly.
        number = np.arange(len(points))
        points[:, 0] += _jitter(number, _JITTER_X) * sampling.cell * _JITTER
        points[:, 2] += _jitter(number, _JITTER_Z) * sampling.cell * _JITTER
        self._points, self._most_error = points, sampling.most_error

    def take_worst(self, vertices: Points, triangles: Int64[np.ndarray, "t 3"]) -> Point | None:
        """The sample whose height is farthest from the triangles', if that is too far."""
        if len(self._points) == 0 or len(triangles) == 0:
            return None
        gaps = _height_gaps(self._points, vertices[triangles])
        worst = int(gaps.argmax())
        if not gaps[worst] > self._most_error:
            return None
        point = self._points[worst]
        self._points = np.delete(self._points, worst, axis=0)
        return point


def _jitter(number: Int64[np.ndarray, " n"], factor: int) -> Float32[np.ndarray, " n"]:
    low = ((number * factor) & 0xFFFF).astype(np.float32)
    return low / _JITTER_RANGE * _TWO - _ONE


def _height_gaps(p: Points, corners: Float32[np.ndarray, "t 3 3"]) -> Float32[np.ndarray, " n"]:
    """Least distance in height of points to the triangles above or below them; -1 beside all."""
    a, c = corners[:, 0], corners[:, 2]
    ux, uy, uz = (c - a).T
    vx, vy, vz = (corners[:, 1] - a).T
    wx, wz = p[:, None, 0] - a[:, 0], p[:, None, 2] - a[:, 2]
    uu, uv, uw = ux * ux + uz * uz, ux * vx + uz * vz, ux * wx + uz * wz
    vv, vw = vx * vx + vz * vz, vx * wx + vz * wz
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        inverse = _ONE / (uu * vv - uv * uv)
        s, t = (vv * uw - uv * vw) * inverse, (uu * vw - uv * uw) * inverse
        gaps = np.abs(a[:, 1] + uy * s + vy * t - p[:, None, 1])
        inside = (s >= -_INSIDE) & (t >= -_INSIDE) & (s + t <= _ONE + _INSIDE)
    least = np.where(inside, gaps, np.inf).min(axis=1)
    return np.where(least < np.inf, least, -_ONE)


class Detail(NamedTuple):
    """The detail mesh of a polygon.

    Attributes:
        points: Vertices in Habitat's frame, metres, those of the polygon first.
        triangles: Corners and the flags of the edges: two bits for each, the lower one says that it
            lies on the polygon's boundary.
    """

    points: Points
    triangles: UInt8[np.ndarray, "t 4"]


def detail_meshes(
    space: OpenSpace,
    regions: Int32[np.ndarray, " s"],
    polygons: Polygons,
    origin: Float32[np.ndarray, " 3"],
    sampling: Sampling,
) -> list[Detail]:
    """The detail meshes of all polygons.

    Args:
        space: Open space, eroded.
        regions: Region of every span.
        polygons: The polygons.
        origin: Lowest corner, Habitat's frame, metres.
        sampling: How heights are sampled.
    """
    cell, height = sampling.cell, sampling.cell_height
    scale = np.array([cell, height, cell], dtype=np.float32)
    known = Regions(space, regions)
    # Recast lifts the vertices by a voxel, but not the outline to which it compares them.
    lifted = origin + np.array([0, height, 0], dtype=np.float32)
    details = []
    for padded, region in zip(polygons.corners, polygons.regions.tolist(), strict=True):
        corners = polygons.vertices[padded[padded >= 0]]
        outline = corners.astype(np.float32) * scale
        points, faces = _detail(outline, Patch(known, region, corners), sampling)
        points = points + lifted
        triangles = np.zeros((len(faces), 4), dtype=np.uint8)
        triangles[:, :3] = faces
        triangles[:, 3] = _flags(outline + origin, points, faces)
        details.append(Detail(points, triangles))
    return details


def _detail(
    outline: Points, patch: Patch, sampling: Sampling
) -> tuple[Points, Int64[np.ndarray, "t 3"]]:
    """Vertices and triangles of one detail mesh."""
    points, hull = list(outline), []
    for i in range(len(outline)):
        first = (i - 1) % len(outline)
        inner = _sampled_side(outline[first], outline[i], patch, sampling, len(points))
        hull += [first, *range(len(points), len(points) + len(inner))]
        points += inner
    vertices = np.array(points)
    triangles = triangles_of_hull(vertices, hull, len(outline))
    if not least_width(outline) < sampling.spacing * _TWO:
        samples = InnerSamples(outline, patch, sampling)
        while len(vertices) < _MOST_VERTICES:
            worst = samples.take_worst(vertices, np.array(triangles))
            if worst is None:
                break
            vertices = np.concatenate([vertices, worst[None]])
            triangles = delaunay(vertices, hull)
    return vertices, np.array(triangles[:_MOST_TRIANGLES], dtype=np.int64).reshape(-1, 3)


def _sampled_side(a: Point, b: Point, patch: Patch, sampling: Sampling, count: int) -> list[Point]:
    """Vertices along a side where its heights leave the straight line."""
    # Polygons on both sides have to agree.
    swapped = a[2] > b[2] if abs(a[0] - b[0]) < _SAME else a[0] > b[0]
    if swapped:
        a, b = b, a
    d = b - a
    steps = 1 + math.floor(np.sqrt(d[0] * d[0] + d[2] * d[2]) / sampling.spacing)
    steps = min(steps, _MOST_EDGE_SAMPLES, _MOST_VERTICES - 1 - count)
    if steps < 2:
        return []
    u = np.arange(steps + 1, dtype=np.float32) / np.float32(steps)
    samples = a + d * u[:, None]
    samples[:, 1] = patch.at(samples, sampling).astype(np.float32) * sampling.cell_height
    kept = _kept_samples(samples, sampling.most_error)[1:-1]
    return [samples[k] for k in (kept[::-1] if swapped else kept)]


def _kept_samples(samples: Points, most_error: np.float32) -> list[int]:
    """The samples between which a side is straight enough."""
    kept = [0, len(samples) - 1]
    k = 0
    while k < len(kept) - 1:
        a, b = kept[k], kept[k + 1]
        gaps = squared_to_segment(samples[a + 1 : b], samples[a], samples[b])
        if len(gaps) and gaps.max() > most_error * most_error:
            kept.insert(k + 1, a + 1 + int(gaps.argmax()))
        else:
            k += 1
    return kept


def _flags(
    outline: Points, points: Points, faces: Int64[np.ndarray, "t 3"]
) -> Int64[np.ndarray, " t"]:
    """The flags of every triangle's edges."""
    on_side = squared_to_sides(points, outline) < _EDGE_GAP_SQUARED
    ends = on_side[faces], on_side[np.roll(faces, -1, axis=1)]
    on_boundary = (ends[0] & ends[1]).any(axis=2)
    return on_boundary @ np.array([1, 4, 16])
