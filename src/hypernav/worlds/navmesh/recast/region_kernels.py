"""Merges small regions with their neighbours, or drops them (numba kernels).

As ``mergeAndFilterRegions``. Lists of all regions are in one pool: each has a beginning and a
length, and a list that grows moves to the end.
"""

import numpy as np
from numba import njit

from hypernav.worlds.navmesh.recast.open_space_kernels import NOTHING

_MOST_EDGES = 40_000
"""Largest number of edges of an outline that are followed."""
_LARGEST = 0xFFFFFFF


@njit(cache=True, nogil=True)
def join_regions(space, regions, count, least, mergeable):
    """Renumber the regions, without those that are too small.

    Args:
        space: Open space, eroded.
        regions: Region of every span; changed in place.
        count: Number of regions with region 0.
        least: Smallest number of spans of connected regions together.
        mergeable: Largest number of spans of a region that is merged with a neighbour.

    Returns:
        The number of regions without region 0.
    """
    sizes = np.zeros(count, dtype=np.int64)
    for i in range(len(regions)):
        sizes[regions[i]] += 1
    sizes[0] = 0
    overlaps = np.zeros(count, dtype=np.bool_)
    floors = _floors(space, regions, count, overlaps)
    borders = _borders(space, regions, count)
    ids = np.arange(count)
    _drop_small(borders, sizes, ids, least)
    merged = True
    while merged:
        merged = False
        for region in range(1, count):
            if ids[region] == 0 or overlaps[region] or sizes[region] == 0:
                continue
            if sizes[region] > mergeable and (_list(borders, region) == 0).any():
                continue
            target = _partner(borders, floors, sizes, ids, overlaps, region)
            if target == region:
                continue
            joined, borders = _joined_borders(borders, target, region)
            if not joined:
                continue
            floors = _append(floors, target, _union(_list(floors, target), _list(floors, region)))
            sizes[target] += sizes[region]
            sizes[region] = 0
            for j in range(count):
                if ids[j] == 0:
                    continue
                if ids[j] == region:
                    ids[j] = target
                _replace(borders, floors, j, region, target)
            merged = True
    return _renumber(regions, ids)


@njit(cache=True, nogil=True)
def _list(lists, region):
    pool, begin, length = lists
    return pool[begin[region] : begin[region] + length[region]]


@njit(cache=True, nogil=True)
def _append(lists, region, values):
    """Give a region another list, at the end of the pool."""
    pool, begin, length = lists
    end = (begin + length).max()
    while end + len(values) > len(pool):
        pool = np.concatenate((pool, np.empty_like(pool)))
    pool[end : end + len(values)] = values
    begin[region], length[region] = end, len(values)
    return pool, begin, length


@njit(cache=True, nogil=True)
def _floors(space, regions, count, overlaps):
    """Regions above and below every region; marks those that overlap themselves."""
    pairs = np.empty(1024, dtype=np.int64)
    used = 0
    for column in range(len(space.start) - 1):
        for i in range(space.start[column], space.start[column + 1]):
            for k in range(space.start[column], space.start[column + 1]):
                if i == k or regions[i] == 0 or regions[k] == 0:
                    continue
                if regions[i] == regions[k]:
                    overlaps[regions[i]] = True
                if used == len(pairs):
                    pairs = np.concatenate((np.unique(pairs), np.empty_like(pairs)))
                    used = len(pairs) - used
                pairs[used] = np.int64(regions[i]) * count + regions[k]
                used += 1
    unique = np.unique(pairs[:used])
    begin, length = np.zeros(count, dtype=np.int64), np.zeros(count, dtype=np.int64)
    for pair in unique:
        length[pair // count] += 1
    begin[1:] = np.cumsum(length)[:-1]
    pool = np.zeros(len(unique) + 64, dtype=np.int64)
    pool[: len(unique)] = unique % count
    return pool, begin, length


@njit(cache=True, nogil=True)
def _borders(space, regions, count):
    """Regions along the outline of every region, in its order."""
    lists = (
        np.zeros(1024, dtype=np.int64),
        np.zeros(count, dtype=np.int64),
        np.zeros(count, dtype=np.int64),
    )
    around = np.empty(_MOST_EDGES + 1, dtype=np.int64)
    for i in range(len(regions)):
        if regions[i] == 0 or lists[2][regions[i]] > 0:
            continue
        for direction in range(4):
            if _beyond(space, regions, i, direction) != regions[i]:
                length = _walk(space, regions, i, direction, around)
                lists = _append(lists, regions[i], around[:length])
                break
    return lists


@njit(cache=True, nogil=True)
def _beyond(space, regions, i, direction):
    beside = space.neighbours[i, direction]
    return 0 if beside == NOTHING else regions[beside]


@njit(cache=True, nogil=True)
def _walk(space, regions, i, direction, around):
    """Follow an outline and write the regions beyond it; returns their number."""
    first, first_direction = i, direction
    around[0] = _beyond(space, regions, i, direction)
    length = 1
    for _ in range(_MOST_EDGES - 1):
        beyond = _beyond(space, regions, i, direction)
        if beyond != regions[i]:
            if beyond != around[length - 1]:
                around[length] = beyond
                length += 1
            direction = (direction + 1) & 3
        else:
            i = space.neighbours[i, direction]
            direction = (direction + 3) & 3
        if i == first and direction == first_direction:
            break
    return _without_repeats(around, length)


@njit(cache=True, nogil=True)
def _without_repeats(values, length):
    """Drop values that equal the next one, around the list; returns what is left of its length."""
    k = 0
    while k < length and length > 1:
        if values[k] == values[(k + 1) % length]:
            for j in range(k, length - 1):
                values[j] = values[j + 1]
            length -= 1
        else:
            k += 1
    return length


@njit(cache=True, nogil=True)
def _drop_small(borders, sizes, ids, least):
    """Drop regions that have too few spans with all that are connected to them."""
    count = len(ids)
    visited = np.zeros(count, dtype=np.bool_)
    stack, trace = np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64)
    for seed in range(1, count):
        if ids[seed] == 0 or sizes[seed] == 0 or visited[seed]:
            continue
        visited[seed] = True
        stack[0] = seed
        depth, traced, total = 1, 0, 0
        while depth > 0:
            depth -= 1
            region = stack[depth]
            total += sizes[region]
            trace[traced] = region
            traced += 1
            for other in _list(borders, region):
                if visited[other] or ids[other] == 0:
                    continue
                visited[other] = True
                stack[depth] = other
                depth += 1
        if total < least:
            for k in range(traced):
                sizes[trace[k]], ids[trace[k]] = 0, 0


@njit(cache=True, nogil=True)
def _partner(borders, floors, sizes, ids, overlaps, region):
    """The smallest neighbour that a region can be joined with; the region itself if none."""
    smallest, partner = _LARGEST, region
    for other in _list(borders, region):
        if ids[other] == 0 or overlaps[other] or sizes[other] >= smallest:
            continue
        if _fits(borders, floors, region, other) and _fits(borders, floors, other, region):
            smallest, partner = sizes[other], other
    return partner


@njit(cache=True, nogil=True)
def _fits(borders, floors, region, other):
    """Whether another region touches this one at most once and is nowhere above or below it."""
    touches = (_list(borders, region) == other).sum()
    return touches <= 1 and not (_list(floors, region) == other).any()


@njit(cache=True, nogil=True)
def _joined_borders(borders, target, region):
    """The neighbours around two regions, opened where they touch; False if they don't."""
    ours, theirs = _list(borders, target).copy(), _list(borders, region).copy()
    at_ours, at_theirs = _find(ours, region), _find(theirs, target)
    if at_ours < 0 or at_theirs < 0:
        return False, borders
    values = np.empty(len(ours) + len(theirs), dtype=np.int64)
    n = 0
    for k in range(len(ours) - 1):
        values[n] = ours[(at_ours + 1 + k) % len(ours)]
        n += 1
    for k in range(len(theirs) - 1):
        values[n] = theirs[(at_theirs + 1 + k) % len(theirs)]
        n += 1
    borders[2][region] = 0
    return True, _append(borders, target, values[: _without_repeats(values, n)])


@njit(cache=True, nogil=True)
def _find(values, value):
    for k in range(len(values)):
        if values[k] == value:
            return k
    return -1


@njit(cache=True, nogil=True)
def _union(ours, theirs):
    return np.unique(np.concatenate((ours, theirs)))


@njit(cache=True, nogil=True)
def _replace(borders, floors, region, old, new):
    """Write a region's new number into the lists of another."""
    replaced = False
    values = _list(borders, region)
    for k in range(len(values)):
        if values[k] == old:
            values[k] = new
            replaced = True
    if replaced:
        borders[2][region] = _without_repeats(values, len(values))
    values = _list(floors, region)
    for k in range(len(values)):
        if values[k] == old:
            values[k] = new


@njit(cache=True, nogil=True)
def _renumber(regions, ids):
    """Renumber the regions without gaps, in the order of the first of the merged regions."""
    number = np.zeros(len(ids), dtype=np.int32)
    used = 0
    for region in range(len(ids)):
        if ids[region] != 0 and number[ids[region]] == 0:
            used += 1
            number[ids[region]] = used
    for i in range(len(regions)):
        regions[i] = number[ids[regions[i]]]
    return used
