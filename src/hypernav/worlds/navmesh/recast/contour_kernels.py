"""Outlines of regions, traced and simplified (numba kernels), as ``RecastContour.cpp``.

A corner is a row of column x, height in voxels, column z, and what is beyond the side that begins
there: the region's number, with `AREA_BORDER` where only the robot's radius prevents walking.
Outlines of opposite direction are holes.
"""

import numpy as np
from numba import njit

from hypernav.worlds.navmesh.recast.lattice_kernels import is_same
from hypernav.worlds.navmesh.recast.open_space_kernels import NOTHING

AREA_BORDER = 0x20000
REGION_MASK = 0xFFFF
_MOST_STEPS = 40_000
_ZERO = np.float32(0.0)
_ONE = np.float32(1.0)


@njit(cache=True, nogil=True)
def trace_contours(space, regions, most_error, longest):
    """The simplified outlines of all regions.

    Args:
        space: Open space, eroded.
        regions: Region of every span.
        most_error: Columns by which a simplified outline may differ from the true one, single
            precision.
        longest: Largest length of a side along a wall, columns.

    Returns:
        Corners of all outlines, first corner of every outline with the number of corners, and the
        region of every outline.
    """
    flags = _open_sides(space, regions)
    raw = np.empty((_MOST_STEPS, 4), dtype=np.int64)
    corners = np.empty((1024, 4), dtype=np.int64)
    start = np.zeros(len(regions) + 1, dtype=np.int64)
    owner = np.zeros(len(regions), dtype=np.int64)
    count = 0
    for i in range(len(regions)):
        if flags[i] == 0 or flags[i] == 0xF:
            flags[i] = 0
            continue
        length = _walk(space, regions, i, flags, raw)
        simple = _without_equal(_simplified(raw[:length], most_error, longest))
        if len(simple) < 3:
            continue
        end = start[count] + len(simple)
        while end > len(corners):
            corners = np.concatenate((corners, np.empty_like(corners)))
        corners[start[count] : end] = simple
        owner[count] = regions[i]
        count += 1
        start[count] = end
    return corners[: start[count]].copy(), start[: count + 1].copy(), owner[:count].copy()


@njit(cache=True, nogil=True)
def _open_sides(space, regions):
    """For every span a bit for each side beyond which there is another region or none."""
    flags = np.zeros(len(regions), dtype=np.uint8)
    for i in range(len(regions)):
        if regions[i] == 0:
            continue
        for direction in range(4):
            beside = space.neighbours[i, direction]
            if beside == NOTHING or regions[beside] != regions[i]:
                flags[i] |= 1 << direction
    return flags


@njit(cache=True, nogil=True)
def _walk(space, regions, i, flags, raw):
    """Follow an outline and write its corners; returns their number."""
    direction = 0
    while flags[i] & (1 << direction) == 0:
        direction += 1
    first, first_direction = i, direction
    length = 0
    for _ in range(_MOST_STEPS - 1):
        if flags[i] & (1 << direction):
            beside = space.neighbours[i, direction]
            raw[length, 0] = space.x[i] + (1 if direction == 1 or direction == 2 else 0)
            raw[length, 1] = _corner_height(space, i, direction)
            raw[length, 2] = space.z[i] + (1 if direction == 0 or direction == 1 else 0)
            raw[length, 3] = 0
            if beside != NOTHING:
                raw[length, 3] = regions[beside]
                if not space.walkable[beside]:
                    raw[length, 3] |= AREA_BORDER
            length += 1
            flags[i] &= ~(1 << direction) & 0xF
            direction = (direction + 1) & 3
        else:
            i = space.neighbours[i, direction]
            direction = (direction + 3) & 3
        if i == first and direction == first_direction:
            break
    return length


@njit(cache=True, nogil=True)
def _corner_height(space, i, direction):
    """The highest floor of the spans around the corner at the end of a span's side."""
    height = space.floor[i]
    turned = (direction + 1) & 3
    for one, other in ((direction, turned), (turned, direction)):
        beside = space.neighbours[i, one]
        if beside != NOTHING:
            height = max(height, space.floor[beside])
            corner = space.neighbours[beside, other]
            if corner != NOTHING:
                height = max(height, space.floor[corner])
    return height


@njit(cache=True, nogil=True)
def _simplified(raw, most_error, longest):
    """Simplified corners, including those between regions, with what is beyond each side."""
    count = len(raw)
    chosen = np.empty(count + 2, dtype=np.int64)
    length = _first_corners(raw, chosen)
    i = 0
    while i < length:
        farthest = _farthest(raw, chosen[i], chosen[(i + 1) % length], most_error)
        if farthest < 0:
            i += 1
        else:
            length = _insert(chosen, length, i + 1, farthest)
    i = 0
    while i < length:
        middle = _middle(raw, chosen[i], chosen[(i + 1) % length], longest)
        if middle < 0:
            i += 1
        else:
            length = _insert(chosen, length, i + 1, middle)
    corners = raw[chosen[:length]]
    for k in range(length):
        # The side after a corner is that of the next true corner.
        corners[k, 3] = raw[(chosen[k] + 1) % count, 3]
    return corners


@njit(cache=True, nogil=True)
def _insert(chosen, length, place, value):
    for k in range(length, place, -1):
        chosen[k] = chosen[k - 1]
    chosen[place] = value
    return length + 1


@njit(cache=True, nogil=True)
def _first_corners(raw, chosen):
    """Corners where what lies beyond changes; without neighbours, two opposite ones."""
    count, length = len(raw), 0
    if ((raw[:, 3] & REGION_MASK) != 0).any():
        for k in range(count):
            if raw[k, 3] != raw[(k + 1) % count, 3]:
                chosen[length] = k
                length += 1
    if length > 0:
        return length
    low, high = 0, 0
    for k in range(1, count):
        if _is_before(raw[k], raw[low]):
            low = k
        if _is_before(raw[high], raw[k]):
            high = k
    chosen[0], chosen[1] = low, high
    return 2


@njit(cache=True, nogil=True)
def _is_before(a, b):
    return a[0] < b[0] or (a[0] == b[0] and a[2] < b[2])


@njit(cache=True, nogil=True)
def _farthest(raw, a, b, most_error):
    """The true corner farthest from a side, if too far; -1 if none. Only sides along borders."""
    count = len(raw)
    # Neighbours trace a common side in opposite directions and must get the same result.
    step, begin, end = 1, a, b
    if not _is_before(raw[a], raw[b]):
        step, begin, end = count - 1, b, a
    k = (begin + step) % count
    if raw[k, 3] & REGION_MASK != 0 and raw[k, 3] & AREA_BORDER == 0:
        return -1
    farthest, gap = -1, _ZERO
    while k != end:
        distance = _squared_distance(raw[k], raw[begin], raw[end])
        if distance > gap:
            farthest, gap = k, distance
        k = (k + step) % count
    return farthest if gap > most_error * most_error else -1


@njit(cache=True, nogil=True)
def _squared_distance(p, a, b):
    """Squared distance of a point to a segment, single precision."""
    ux, uz = np.float32(b[0] - a[0]), np.float32(b[2] - a[2])
    dx, dz = np.float32(p[0] - a[0]), np.float32(p[2] - a[2])
    length = ux * ux + uz * uz
    t = ux * dx + uz * dz
    if length > _ZERO:
        t = t / length
    t = min(max(t, _ZERO), _ONE)
    dx = np.float32(a[0]) + t * ux - np.float32(p[0])
    dz = np.float32(a[2]) + t * uz - np.float32(p[2])
    return dx * dx + dz * dz


@njit(cache=True, nogil=True)
def _middle(raw, a, b, longest):
    """The true corner in the middle of a side along a wall, if that is too long; -1 if not."""
    count = len(raw)
    if raw[(a + 1) % count, 3] & REGION_MASK != 0:
        return -1
    dx, dz = raw[b, 0] - raw[a, 0], raw[b, 2] - raw[a, 2]
    steps = (b - a) % count if b != a else 0
    if dx * dx + dz * dz <= longest * longest or steps <= 1:
        return -1
    return (a + (steps if _is_before(raw[a], raw[b]) else steps + 1) // 2) % count


@njit(cache=True, nogil=True)
def _without_equal(corners):
    """Drop corners at the same position as the next one."""
    length = len(corners)
    k = 0
    while k < length:
        if is_same(corners[k], corners[(k + 1) % length]):
            for j in range(k, length - 1):
                corners[j] = corners[j + 1]
            length -= 1
        k += 1
    return corners[:length]
