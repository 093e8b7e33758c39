"""Outlines of regions, traced and simplified, their holes joined to them by bridges.

As ``RecastContour.cpp``, with its ``mergeRegionHoles``. A corner is a row of column x, height in
voxels, column z, and what lies beyond the side that begins there: the region's number, and
`AREA_BORDER` where the robot could walk but for its radius. Outlines that run the other way round
are holes.

Plane geometry is on whole numbers. Points are arrays whose last axis begins with x, height and z.
"Left" is seen with z downwards, which is the inner side of an outline as it is traced here.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float32, Int32, Int64

from hypernav.simulator.worlds.navmesh.recast_detour.recast_regions import Outlines
from hypernav.simulator.worlds.navmesh.recast_detour.recast_voxels import NOTHING, OpenSpace

Points = Int64[np.ndarray, "..."]
Numbers = Int64[np.ndarray, "..."] | np.int64
Answers = Bool[np.ndarray, "..."] | np.bool_
AREA_BORDER = 0x20000
REGION_MASK = 0xFFFF
_ZERO, _ONE = np.float32(0.0), np.float32(1.0)
Corners = Int64[np.ndarray, "... 4"]
Corner = Int64[np.ndarray, " 4"]


def area2(a: Points, b: Points, c: Points) -> Numbers:
    """Twice the signed area of triangles; negative if c is left of the line from a to b."""
    ax, az = a[..., 0], a[..., 2]
    return (b[..., 0] - ax) * (c[..., 2] - az) - (c[..., 0] - ax) * (b[..., 2] - az)


def is_same(a: Points, b: Points) -> Answers:
    """Whether two points are equal in the plane."""
    return (a[..., 0] == b[..., 0]) & (a[..., 2] == b[..., 2])


def squared_gap(a: Points, b: Points) -> Numbers:
    """Squared distance in the plane."""
    return (b[..., 0] - a[..., 0]) ** 2 + (b[..., 2] - a[..., 2]) ** 2


def crosses(a: Points, b: Points, c: Points, d: Points) -> Answers:
    """Whether two segments cross at an inner point of both."""
    return (np.sign(area2(a, b, c)) * np.sign(area2(a, b, d)) < 0) & (
        np.sign(area2(c, d, a)) * np.sign(area2(c, d, b)) < 0
    )


def touches(a: Points, b: Points, c: Points, d: Points) -> Answers:
    """Whether two segments have a point in common."""
    return (
        crosses(a, b, c, d)
        | _between(a, b, c)
        | _between(a, b, d)
        | _between(c, d, a)
        | _between(c, d, b)
    )


def is_in_cone(before: Points, corner: Points, after: Points, point: Points) -> Answers:
    """Whether a point lies strictly in the inner angle of an outline's corner."""
    convex = (area2(corner, point, before) < 0) & (area2(point, corner, after) < 0)
    outside = (area2(corner, point, after) <= 0) & (area2(point, corner, before) <= 0)
    return np.where(area2(before, corner, after) <= 0, convex, ~outside)


def is_in_closed_cone(before: Points, corner: Points, after: Points, point: Points) -> Answers:
    """The same, with the sides of a convex corner."""
    convex = (area2(corner, point, before) <= 0) & (area2(point, corner, after) <= 0)
    outside = (area2(corner, point, after) <= 0) & (area2(point, corner, before) <= 0)
    return np.where(area2(before, corner, after) <= 0, convex, ~outside)


def _between(a: Points, b: Points, c: Points) -> Answers:
    """Whether c lies on the segment from a to b."""
    within = np.where(
        a[..., 0] != b[..., 0],
        (c[..., 0] - a[..., 0]) * (c[..., 0] - b[..., 0]) <= 0,
        (c[..., 2] - a[..., 2]) * (c[..., 2] - b[..., 2]) <= 0,
    )
    return within & (area2(a, b, c) == 0)


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


def join_holes(contours: list[Contour]) -> list[Contour]:
    """Join all holes.

    Returns:
        The contours; a hole has no corners left, unless no bridge to it was found.
    """
    joined = list(contours)
    outline = {}
    holes: dict[int, list[int]] = {}
    for k, contour in enumerate(contours):
        if _runs_back(contour.corners):
            holes.setdefault(contour.region, []).append(k)
        else:
            outline[contour.region] = k
    for region in sorted(holes.keys() & outline.keys()):
        _join(joined, outline[region], holes[region])
    return joined


def _runs_back(corners: Corners) -> bool:
    """Whether a contour is a hole's; one of a single column's area, or less, never is."""
    x, z = corners[:, 0], corners[:, 2]
    return bool((x * np.roll(z, 1) - np.roll(x, 1) * z).sum() <= -3)


def _join(contours: list[Contour], outline: int, holes: list[int]) -> None:
    """Join the holes of one outline, from left to right."""
    region = contours[outline].region
    places = {hole: contours[hole].corners[:, [0, 2]].tolist() for hole in holes}
    leftmost = {hole: places[hole].index(min(places[hole])) for hole in holes}
    ordered = sorted(holes, key=lambda hole: places[hole][leftmost[hole]])
    nearest: list[int] = []
    for k, hole in enumerate(ordered):
        beside = [contours[other].corners for other in ordered[k:]]
        line, corners = contours[outline].corners, contours[hole].corners
        for turn in range(len(corners)):
            at = (leftmost[hole] + turn) % len(corners)
            bridge = _bridge(line, corners[at], beside, k, nearest)
            if bridge is not None:
                parts = np.concatenate([_around(line, bridge), _around(corners, at)])
                contours[outline] = Contour(parts, region)
                contours[hole] = Contour(corners[:0], region)
                break


def _around(corners: Corners, first: int) -> Corners:
    """A whole turn, with the first corner at its end again."""
    return np.concatenate([corners[first:], corners[: first + 1]])


def _bridge(
    line: Corners, corner: Corner, holes: list[Corners], k: int, nearest: list[int]
) -> int | None:
    """The nearest corner of the outline that is seen from a corner of a hole.

    Args:
        line: The outline.
        corner: The corner.
        holes: The hole and those that are not joined yet.
        k: How many have been looked at before.
        nearest: What was found for the corners before this one; written over.
    """
    visible = is_in_cone(np.roll(line, 1, axis=0), line, np.roll(line, -1, axis=0), corner)
    candidates = np.flatnonzero(visible)
    order = np.argsort(squared_gap(line[candidates], corner), kind="stable")
    found = candidates[order].tolist()
    nearest[: len(found)] = found
    # Recast leaves out the sides at the k-th nearest corner, whichever corner it tries.
    left_out = nearest[k] if k < len(nearest) else 0
    for at in found:
        if not _is_blocked(line[at], corner, line, left_out) and not any(
            _is_blocked(line[at], corner, hole, None) for hole in holes
        ):
            return at
    return None


def _is_blocked(a: Corner, b: Corner, line: Corners, except_at: int | None) -> bool:
    """Whether a contour meets a segment elsewhere than at its ends."""
    after = np.roll(line, -1, axis=0)
    at_end = is_same(line, a) | is_same(line, b)
    counts = ~(at_end | np.roll(at_end, -1))
    if except_at is not None:
        counts[[except_at, except_at - 1]] = False
    return bool((counts & touches(a, b, line, after)).any())
