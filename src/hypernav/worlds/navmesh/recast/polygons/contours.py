"""Outlines of regions, traced and simplified, as ``RecastContour.cpp``.

A corner is a row of column x, height in voxels, column z, and what lies beyond the side that
begins there: the region's number, and `AREA_BORDER` where the robot could walk but for its radius.
Outlines that run the other way round are holes.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Int32, Int64

from hypernav.worlds.navmesh.recast.polygons.lattice import is_same
from hypernav.worlds.navmesh.recast.regions.outlines import Outlines
from hypernav.worlds.navmesh.recast.voxels.open_space import NOTHING, OpenSpace

AREA_BORDER = 0x20000
REGION_MASK = 0xFFFF
_ZERO, _ONE = np.float32(0.0), np.float32(1.0)

Corners = Int64[np.ndarray, "... 4"]
Corner = Int64[np.ndarray, " 4"]


class Contour(NamedTuple):
    """The simplified outline of a region, or of a hole in it.

    Attributes:
        corners: Its corners.
        region: The region.
    """

    corners: Corners
    region: int


def trace_contours(
    space: OpenSpace, regions: Int32[np.ndarray, " s"], most_error: np.float32, longest: int
) -> list[Contour]:
    """The simplified outlines of all regions.

    Args:
        space: Open space, eroded.
        regions: Region of every span.
        most_error: Columns by which a simplified outline may leave the true one, single precision.
        longest: Columns that a side along a wall may be long.
    """
    outlines = Outlines(space, regions)
    true_corners = _true_corners(space, outlines)
    left = outlines.is_edge.copy()
    # What has edges on all sides is left out.
    left[left.all(axis=1)] = False
    contours = []
    for i in np.flatnonzero(left.any(axis=1)).tolist():
        if left[i].any():
            edges = outlines.follow(4 * i + int(left[i].argmax()))
            left.ravel()[edges] = False
            corners = _without_equal(_simplified(true_corners[edges], most_error, longest))
            if len(corners) >= 3:
                contours.append(Contour(corners, int(regions[i])))
    return contours


def _true_corners(space: OpenSpace, outlines: Outlines) -> Corners:
    """The corner that begins each side of every span."""
    corners = np.zeros((*space.neighbours.shape, 4), dtype=np.int64)
    floor = np.append(space.floor, np.int32(0))  # that of a neighbour that there is none of
    for direction in range(4):
        height = space.floor
        for one, other in ((direction, direction + 1 & 3), (direction + 1 & 3, direction)):
            beside = space.neighbours[:, one]
            corner = np.where(beside == NOTHING, NOTHING, space.neighbours[beside, other])
            height = np.maximum(height, np.maximum(floor[beside], floor[corner]))
        beside = space.neighbours[:, direction]
        border = (beside != NOTHING) & ~space.walkable[beside]
        corners[:, direction, 0] = space.x + (direction in (1, 2))
        corners[:, direction, 1] = height
        corners[:, direction, 2] = space.z + (direction in (0, 1))
        corners[:, direction, 3] = outlines.beyond[:, direction] | np.where(border, AREA_BORDER, 0)
    return corners.reshape(-1, 4)


def _simplified(raw: Corners, most_error: np.float32, longest: int) -> Corners:
    """Fewer corners, those between regions among them; with what lies beyond each side."""
    chosen = _first_corners(raw)
    i = 0
    while i < len(chosen):
        farthest = _farthest(raw, chosen[i], chosen[(i + 1) % len(chosen)], most_error)
        if farthest is None:
            i += 1
        else:
            chosen.insert(i + 1, farthest)
    i = 0
    while i < len(chosen):
        middle = _middle(raw, chosen[i], chosen[(i + 1) % len(chosen)], longest)
        if middle is None:
            i += 1
        else:
            chosen.insert(i + 1, middle)
    corners = raw[chosen]
    # The side after a corner is that of the next true corner.
    corners[:, 3] = raw[(np.array(chosen) + 1) % len(raw), 3]
    return corners


def _first_corners(raw: Corners) -> list[int]:
    """Corners where what lies beyond changes; without neighbours, two opposite ones."""
    if (raw[:, 3] & REGION_MASK).any():
        changes = np.flatnonzero(raw[:, 3] != np.roll(raw[:, 3], -1))
        if len(changes):
            return changes.tolist()
    order = np.lexsort((raw[:, 2], raw[:, 0]))
    high = raw[order[-1], [0, 2]]
    return [int(order[0]), int(np.flatnonzero((raw[:, [0, 2]] == high).all(axis=1))[0])]


def _is_before(a: Corner, b: Corner) -> bool:
    return bool(a[0] < b[0] or (a[0] == b[0] and a[2] < b[2]))


def _farthest(raw: Corners, a: int, b: int, most_error: np.float32) -> int | None:
    """The true corner farthest from a side, if too far. Only sides along borders."""
    count = len(raw)
    # Neighbours trace a common side in opposite directions and have to agree.
    step, begin, end = 1, a, b
    if not _is_before(raw[a], raw[b]):
        step, begin, end = -1, b, a
    first = (begin + step) % count
    if raw[first, 3] & REGION_MASK != 0 and raw[first, 3] & AREA_BORDER == 0:
        return None
    length = (end - begin) * step % count or count
    if length == 1:
        return None
    between = (begin + step * np.arange(1, length)) % count
    gaps = _squared_distances(raw[between], raw[begin], raw[end])
    farthest = gaps.argmax()
    return int(between[farthest]) if gaps[farthest] > most_error * most_error else None


def _squared_distances(p: Corners, a: Corner, b: Corner) -> Float32[np.ndarray, " n"]:
    """Squared distances of points to a segment, single precision."""
    ux, uz = np.float32(b[0] - a[0]), np.float32(b[2] - a[2])
    dx, dz = (p[:, 0] - a[0]).astype(np.float32), (p[:, 2] - a[2]).astype(np.float32)
    length = ux * ux + uz * uz
    t = ux * dx + uz * dz
    if length > _ZERO:
        t = t / length
    t = np.clip(t, _ZERO, _ONE)
    dx = np.float32(a[0]) + t * ux - p[:, 0].astype(np.float32)
    dz = np.float32(a[2]) + t * uz - p[:, 2].astype(np.float32)
    return dx * dx + dz * dz


def _middle(raw: Corners, a: int, b: int, longest: int) -> int | None:
    """The true corner in the middle of a side along a wall, if that is too long."""
    count = len(raw)
    if raw[(a + 1) % count, 3] & REGION_MASK != 0:
        return None
    dx, dz = (raw[b] - raw[a])[[0, 2]].tolist()
    steps = (b - a) % count
    if dx * dx + dz * dz <= longest * longest or steps <= 1:
        return None
    return (a + (steps if _is_before(raw[a], raw[b]) else steps + 1) // 2) % count


def _without_equal(corners: Corners) -> Corners:
    """Drop corners that lie where the next one does."""
    kept = list(corners)
    k = 0
    while k < len(kept):
        if is_same(kept[k], kept[(k + 1) % len(kept)]):
            del kept[k]
        k += 1
    return np.array(kept, dtype=np.int64).reshape(-1, 4)
