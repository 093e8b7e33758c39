"""Detail meshes: triangles of polygons that follow the voxels' heights.

As ``rcBuildPolyMeshDetail``. Points are in metres from the lowest corner, single precision.
"""

import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Int32, Int64, UInt8

from hypernav.worlds.navmesh.recast.detail.delaunay import delaunay
from hypernav.worlds.navmesh.recast.detail.heights import Patch, Regions, Sampling
from hypernav.worlds.navmesh.recast.detail.hulls import triangles_of_hull
from hypernav.worlds.navmesh.recast.detail.inner_samples import InnerSamples
from hypernav.worlds.navmesh.recast.detail.segments import (
    Point,
    Points,
    least_width,
    squared_to_segment,
    squared_to_sides,
)
from hypernav.worlds.navmesh.recast.polygons.convex import Polygons
from hypernav.worlds.navmesh.recast.voxels.open_space import OpenSpace

_MOST_VERTICES = 127
_MOST_TRIANGLES = 255
_MOST_EDGE_SAMPLES = 31
_TWO = np.float32(2.0)
_SAME = np.float32(1e-6)
_EDGE_GAP_SQUARED = np.float32(0.001) * np.float32(0.001)


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
    """Vertices along a side where its heights leave the straight line.

    Args:
        a: Its first corner.
        b: Its last corner.
        patch: Heights.
        sampling: How they are sampled.
        count: Number of vertices that there are.
    """
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
