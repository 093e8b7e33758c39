"""Regions of the open space by a watershed of the distances (numba kernels).

As ``rcBuildRegions`` before it joins regions. Region 0 is none.
"""

import numpy as np
from numba import njit

from hypernav.worlds.navmesh.recast.open_space_kernels import NOTHING

_STACKS = 8
_STEPS = 8
"""Number of steps by which regions grow at each level before new ones begin."""
_FAR = 0xFFFF


@njit(cache=True, nogil=True)
def watershed(space, distance, greatest):
    """Flood the open space from its middles outwards.

    Args:
        space: Open space, eroded.
        distance: Smoothed distance of every span to a border.
        greatest: Greatest distance before smoothing.

    Returns:
        Region of every span, and the number of regions with region 0.
    """
    count = len(distance)
    regions = np.zeros(count, dtype=np.int32)
    gaps = np.zeros(count, dtype=np.int32)
    cells = np.empty(count, dtype=np.int32)
    bounds = np.zeros(_STACKS + 1, dtype=np.int64)
    stack, changed = np.empty(count, dtype=np.int32), np.empty((count, 3), dtype=np.int32)
    flood = np.empty(count, dtype=np.int32)
    level = (greatest + 1) & ~1
    size, turn, following = 0, _STACKS - 1, 1
    while level > 0:
        level = max(level - 2, 0)
        turn = (turn + 1) % _STACKS
        left = size
        if turn == 0:
            _by_level(space, distance, regions, level, cells, bounds)
            left = 0
        # This level's spans come first, then those left over from the level before.
        own = bounds[turn + 1] - bounds[turn]
        remaining = stack[:left].copy()
        size = 0
        for k in range(own):
            stack[size] = cells[bounds[turn] + k]
            size += 1
        for k in range(left):
            if remaining[k] != NOTHING and regions[remaining[k]] == 0:
                stack[size] = remaining[k]
                size += 1
        for k in range(size):
            if regions[stack[k]] != 0:
                stack[k] = NOTHING
        _expand(space, regions, gaps, stack, size, changed, _STEPS if level > 0 else -1)
        for k in range(size):
            if (
                stack[k] != NOTHING
                and regions[stack[k]] == 0
                and _flood(space, distance, regions, gaps, stack[k], level, following, flood)
            ):
                following += 1
    size = 0
    for i in range(count):
        if regions[i] == 0 and space.walkable[i]:
            stack[size] = i
            size += 1
    _expand(space, regions, gaps, stack, size, changed, -1)
    return regions, following


@njit(cache=True, nogil=True)
def _by_level(space, distance, regions, level, cells, bounds):
    """Sort spans without a region into the stacks of this and the following levels."""
    counts = np.zeros(_STACKS, dtype=np.int64)
    number = np.full(len(regions), _STACKS, dtype=np.int64)
    for i in range(len(regions)):
        if space.walkable[i] and regions[i] == 0:
            number[i] = min(max((level >> 1) - (distance[i] >> 1), 0), _STACKS)
            if number[i] < _STACKS:
                counts[number[i]] += 1
    for k in range(_STACKS):
        bounds[k + 1] = bounds[k] + counts[k]
    place = bounds[:_STACKS].copy()
    for i in range(len(regions)):
        if number[i] < _STACKS:
            cells[place[number[i]]] = i
            place[number[i]] += 1


@njit(cache=True, nogil=True)
def _expand(space, regions, gaps, stack, size, changed, steps):
    """Grow regions over the spans of a stack for a number of steps; -1 for as many as needed.

    Spans that have got a region are replaced by `NOTHING`.
    """
    done = 0
    while size > 0:
        changes = 0
        for k in range(size):
            i = stack[k]
            if i == NOTHING:
                continue
            region, gap = 0, _FAR
            for direction in range(4):
                beside = space.neighbours[i, direction]
                if beside == NOTHING or not space.walkable[beside] or regions[beside] == 0:
                    continue
                if gaps[beside] + 2 < gap:
                    region, gap = regions[beside], gaps[beside] + 2
            if region != 0:
                stack[k] = NOTHING
                changed[changes, 0], changed[changes, 1], changed[changes, 2] = i, region, gap
                changes += 1
        for k in range(changes):
            regions[changed[k, 0]], gaps[changed[k, 0]] = changed[k, 1], changed[k, 2]
        done += 1
        if changes == 0 or done == steps:
            return


@njit(cache=True, nogil=True)
def _flood(space, distance, regions, gaps, seed, level, region, stack):
    """Begin a region at a span; returns whether it has any."""
    regions[seed], gaps[seed] = region, 0
    least = max(level - 2, 0)
    stack[0] = seed
    depth, count = 1, 0
    while depth > 0:
        depth -= 1
        i = stack[depth]
        if _touches_another(space, regions, i, region):
            regions[i] = 0
            continue
        count += 1
        for direction in range(4):
            beside = space.neighbours[i, direction]
            if beside == NOTHING or not space.walkable[beside]:
                continue
            if distance[beside] >= least and regions[beside] == 0:
                regions[beside], gaps[beside] = region, 0
                stack[depth] = beside
                depth += 1
    return count > 0


@njit(cache=True, nogil=True)
def _touches_another(space, regions, i, region):
    """Whether a neighbour, also a diagonal one, has another region."""
    for direction in range(4):
        beside = space.neighbours[i, direction]
        if beside == NOTHING or not space.walkable[beside]:
            continue
        if regions[beside] != 0 and regions[beside] != region:
            return True
        corner = space.neighbours[beside, (direction + 1) & 3]
        if corner == NOTHING or not space.walkable[corner]:
            continue
        if regions[corner] != 0 and regions[corner] != region:
            return True
    return False
