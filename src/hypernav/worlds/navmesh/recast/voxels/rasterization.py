"""Triangles as solid spans in columns of voxels, as ``RecastRasterization.cpp``.

Habitat's frame, y up. Column ``x + z * width``; heights are counted in voxels from the lowest one.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float32, Int32, Int64

from hypernav.worlds.navmesh.recast.voxels.rasterization_kernels import fill

_MOST_CORNERS = 12
_FIRST_ROOM = 1 << 16
_NEXT = 3


class Solid(NamedTuple):
    """Spans that triangles fill, column after column, each from below.

    Attributes:
        start: First span of every column, and the number of spans.
        low: Lowest voxel of every span.
        high: Voxel above every span.
        walkable: Whether a robot can stand on it.
    """

    start: Int64[np.ndarray, " starts"]
    low: Int32[np.ndarray, " s"]
    high: Int32[np.ndarray, " s"]
    walkable: Bool[np.ndarray, " s"]


def walkable_triangles(
    vertices: Float32[np.ndarray, "v 3"], triangles: Int32[np.ndarray, "t 3"], least_up: np.float32
) -> Bool[np.ndarray, " t"]:
    """Whether the upward part of each triangle's unit normal is more than this."""
    a = vertices[triangles[:, 0]]
    ux, uy, uz = (vertices[triangles[:, 1]] - a).T
    vx, vy, vz = (vertices[triangles[:, 2]] - a).T
    x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        return y * (np.float32(1.0) / np.sqrt(x * x + y * y + z * z)) > least_up


def rasterize(
    vertices: Float32[np.ndarray, "v 3"],
    triangles: Int32[np.ndarray, "t 3"],
    walkable: Bool[np.ndarray, " t"],
    bounds: Float32[np.ndarray, "2 3"],
    shape: tuple[int, int],
    cells: Float32[np.ndarray, " 2"],
    climb: int,
) -> Solid:
    """The spans that triangles fill.

    Args:
        vertices: Corners, Habitat's frame, metres.
        triangles: Vertex numbers.
        walkable: Whether a robot can stand on each triangle, as far as its slope tells.
        bounds: Lowest and highest corner of the voxels, metres.
        shape: Columns along z and along x.
        cells: Side of a column and height of a voxel, metres.
        climb: Voxels that the robot climbs; tops no farther apart count as one surface.
    """
    first = np.full(shape, -1, dtype=np.int32)
    spans = np.empty((_FIRST_ROOM, 4), dtype=np.int32)
    parts = np.empty((4, _MOST_CORNERS, 3), dtype=np.float32)
    stands = walkable.astype(np.int32)
    i, used, free = 0, 0, -1
    while i < len(triangles):
        i, used, free, needed = fill(
            vertices, triangles, stands, i, first, spans, used, free, parts, bounds, cells, climb
        )
        if i < len(triangles):
            room = np.empty((max(len(spans), needed), 4), dtype=np.int32)
            spans = np.concatenate([spans, room])
    return _in_order(first.ravel(), spans)


def _in_order(first: Int32[np.ndarray, " c"], spans: Int32[np.ndarray, "s 4"]) -> Solid:
    """The linked spans as arrays."""
    column = np.flatnonzero(first >= 0)
    span = first[column]
    columns, layers = [column], [span]
    while len(span):
        above = spans[span, _NEXT]
        column, span = column[above >= 0], above[above >= 0]
        columns.append(column)
        layers.append(span)
    start = np.zeros(len(first) + 1, dtype=np.int64)
    np.cumsum(np.bincount(np.concatenate(columns), minlength=len(first)), out=start[1:])
    order = np.empty(start[-1], dtype=np.int64)
    for layer, (column, span) in enumerate(zip(columns, layers, strict=True)):
        order[start[column] + layer] = span
    low, high, walkable, _ = spans[order].T
    return Solid(start, low.copy(), high.copy(), walkable == 1)
