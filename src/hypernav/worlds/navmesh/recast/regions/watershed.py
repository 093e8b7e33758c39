"""Regions of the open space by a watershed of the distances.

As ``rcBuildRegions`` before it joins regions. Region 0 is none.
"""

import numpy as np
from jaxtyping import Int32

from hypernav.worlds.navmesh.recast.regions.flood_kernels import flood
from hypernav.worlds.navmesh.recast.voxels.open_space import OpenSpace

_STACKS = 8
_STEPS = 8
"""Steps that regions grow at each level before new ones begin."""
_FAR = 0xFFFF

Spans = Int32[np.ndarray, "..."]


def watershed(space: OpenSpace, distance: Spans, greatest: int) -> tuple[Spans, int]:
    """Flood the open space from its middles outwards.

    Args:
        space: Open space, eroded.
        distance: Smoothed distance of every span to a border.
        greatest: Greatest distance before smoothing.

    Returns:
        Region of every span, and the number of regions with region 0.
    """
    count = len(distance)
    # One entry more than there are spans: a neighbour that there is none of has no region.
    regions, gaps = np.zeros(count + 1, dtype=np.int32), np.zeros(count + 1, dtype=np.int32)
    room = np.empty(count, dtype=np.int32)
    stack, stacks = room[:0], [room[:0]]
    level = (greatest + 1) & ~1
    turn, following = _STACKS - 1, 1
    while level > 0:
        level = max(level - 2, 0)
        turn = (turn + 1) % _STACKS
        if turn == 0:
            stacks, stack = _by_level(space, distance, regions, level), room[:0]
        # This level's own spans come first, then those that the level before has left.
        stack = np.concatenate([stacks[turn], stack])
        stack = stack[regions[stack] == 0]
        stack = _expand(space, regions, gaps, stack, _STEPS if level > 0 else -1)
        least = max(level - 2, 0)
        following = flood(
            space.neighbours, space.walkable, distance, regions, gaps, stack, least, following, room
        )
    left = np.flatnonzero((regions[:count] == 0) & space.walkable).astype(np.int32)
    _expand(space, regions, gaps, left, -1)
    return regions[:count], following


def _by_level(space: OpenSpace, distance: Spans, regions: Spans, level: int) -> list[Spans]:
    """Spans without a region for this and the following levels."""
    free = np.flatnonzero(space.walkable & (regions[:-1] == 0)).astype(np.int32)
    later = np.maximum((level >> 1) - (distance[free] >> 1), 0)
    return [free[later == k] for k in range(_STACKS)]


def _expand(space: OpenSpace, regions: Spans, gaps: Spans, stack: Spans, steps: int) -> Spans:
    """Grow regions over spans, one step after the other; -1 for as many as it takes.

    Returns:
        The spans that have got no region.
    """
    while len(stack) and steps != 0:
        beside = space.neighbours[stack]
        gap = np.where(regions[beside] != 0, gaps[beside] + 2, _FAR)
        nearest = gap.argmin(axis=1)
        row = np.arange(len(stack))
        grown = gap[row, nearest] < _FAR
        if not grown.any():
            break
        source = beside[row, nearest][grown]
        regions[stack[grown]], gaps[stack[grown]] = regions[source], gap.min(axis=1)[grown]
        stack = stack[~grown]
        steps -= 1
    return stack
