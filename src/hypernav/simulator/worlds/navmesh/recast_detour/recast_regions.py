"""Regions of the open space: a watershed of the distances, and small regions joined or dropped.

As ``rcBuildRegions`` and ``mergeAndFilterRegions``. Region 0 is none. An edge of an outline is the
side of a span in one direction: its number is four times the span's, and the direction.
"""

import numpy as np
from jaxtyping import Bool, Int32

from hypernav.simulator.worlds.navmesh.recast_detour.recast_kernels import flood
from hypernav.simulator.worlds.navmesh.recast_detour.recast_voxels import (
    NOTHING,
    OpenSpace,
    columns_of,
)

_MOST_STEPS = 40_000
_STACKS = 8
_STEPS = 8
"""Steps that regions grow at each level before new ones begin."""
_FAR = 0xFFFF
Spans = Int32[np.ndarray, "..."]
_LARGEST = 0xFFFFFFF


class Outlines:
    """The edges beyond which there is another region or none."""

    def __init__(self, space: OpenSpace, regions: Int32[np.ndarray, " s"]) -> None:
        """Find them.

        Args:
            space: Open space.
            regions: Region of every span; 0 for none, which has no edges.
        """
        beside = space.neighbours
        self.beyond: Int32[np.ndarray, "s 4"] = np.where(beside == NOTHING, 0, regions[beside])
        """Region beyond each side of every span."""
        self.is_edge: Bool[np.ndarray, "s 4"] = (self.beyond != regions[:, None]) & (
            regions[:, None] != 0
        )
        """Whether that is another one."""
        self._neighbours: list[int] = beside.ravel().tolist()
        self._edges: list[bool] = self.is_edge.ravel().tolist()

    def follow(self, first: int) -> list[int]:
        """The edges of an outline, from this one on."""
        found, edge = [], first
        for _ in range(_MOST_STEPS - 1):
            if self._edges[edge]:
                found.append(edge)
                edge = edge & ~3 | edge + 1 & 3
            else:
                edge = 4 * self._neighbours[edge] + (edge + 3 & 3)
            if edge == first:
                break
        return found


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


class _Regions:
    """What is known of every region.

    Attributes:
        sizes: Number of spans; 0 once it is joined or dropped.
        ids: The region that it has become part of; 0 once it is dropped.
        floors: Regions above and below it.
        borders: Regions along its outline, in their order.
        overlaps: Whether it lies above itself.
    """

    def __init__(self, space: OpenSpace, regions: Int32[np.ndarray, " s"], count: int) -> None:
        self.sizes: list[int] = np.bincount(regions, minlength=count).tolist()
        self.sizes[0] = 0
        self.ids = list(range(count))
        self.floors: list[set[int]] = [set() for _ in range(count)]
        self.borders: list[list[int]] = [[] for _ in range(count)]
        self.overlaps = [False] * count
        self._stack_floors(space, regions)
        self._follow_borders(space, regions)
        # Those in whose lists a region may stand, and those that have become part of it.
        self._holders: list[set[int]] = [set() for _ in range(count)]
        self._members = [[region] for region in range(count)]
        for region in range(count):
            self._hold(region)

    def _stack_floors(self, space: OpenSpace, regions: Int32[np.ndarray, " s"]) -> None:
        column = columns_of(space.start)
        for apart in range(1, int(np.diff(space.start).max(initial=0))):
            above, below = regions[apart:], regions[:-apart]
            pairs = (column[apart:] == column[:-apart]) & (above != 0) & (below != 0)
            for one, other in np.unique(np.stack([above, below], 1)[pairs], axis=0).tolist():
                self.overlaps[one] |= one == other
                self.floors[one].add(other)
                self.floors[other].add(one)

    def _follow_borders(self, space: OpenSpace, regions: Int32[np.ndarray, " s"]) -> None:
        outlines = Outlines(space, regions)
        edges = np.flatnonzero(outlines.is_edge)
        numbers, first = np.unique(regions[edges // 4], return_index=True)
        beyond = outlines.beyond.ravel()
        for region, edge in zip(numbers.tolist(), edges[first].tolist(), strict=True):
            around = beyond[outlines.follow(edge)]
            changes = np.append(True, around[1:] != around[:-1])
            self.borders[region] = _without_repeats(around[changes].tolist())

    def _hold(self, region: int) -> None:
        for other in (*self.borders[region], *self.floors[region]):
            self._holders[other].add(region)

    def drop_small(self, least: int) -> None:
        """Drop regions that have too few spans with all that are connected to them."""
        visited = set()
        for seed in range(1, len(self.ids)):
            if self.sizes[seed] == 0 or seed in visited:
                continue
            visited.add(seed)
            stack, trace = [seed], []
            while stack:
                region = stack.pop()
                trace.append(region)
                for other in self.borders[region]:
                    if other not in visited and self.ids[other] != 0:
                        visited.add(other)
                        stack.append(other)
            if sum(self.sizes[region] for region in trace) < least:
                for region in trace:
                    self.sizes[region] = self.ids[region] = 0

    def partner(self, region: int) -> int:
        """The smallest neighbour that a region can be joined with; the region itself if none."""
        smallest, partner = _LARGEST, region
        for other in self.borders[region]:
            if self.ids[other] == 0 or self.overlaps[other] or self.sizes[other] >= smallest:
                continue
            if self._fits(region, other) and self._fits(other, region):
                smallest, partner = self.sizes[other], other
        return partner

    def _fits(self, region: int, other: int) -> bool:
        """Whether another touches this one at most once and lies nowhere above or below it."""
        return self.borders[region].count(other) <= 1 and other not in self.floors[region]

    def join(self, target: int, region: int) -> bool:
        """Make a region part of another; returns whether they touch, without which they can't."""
        ours, theirs = self.borders[target], self.borders[region]
        if region not in ours or target not in theirs:
            return False
        at, there = ours.index(region), theirs.index(target)
        around = [*ours[at + 1 :], *ours[:at], *theirs[there + 1 :], *theirs[:there]]
        self.borders[target], self.borders[region] = _without_repeats(around), []
        self.floors[target] |= self.floors[region]
        self.sizes[target] += self.sizes[region]
        self.sizes[region] = 0
        self._hold(target)
        self._rename(region, target)
        return True

    def _rename(self, old: int, new: int) -> None:
        """Write a region's new number into the lists of all others."""
        for member in self._members[old]:
            self.ids[member] = new
        self._members[new] += self._members[old]
        for holder in self._holders[old]:
            if old in self.borders[holder]:
                renamed = [new if other == old else other for other in self.borders[holder]]
                self.borders[holder] = _without_repeats(renamed)
            if old in self.floors[holder]:
                self.floors[holder] = self.floors[holder] - {old} | {new}
        self._holders[new] |= self._holders[old]


def join_regions(
    space: OpenSpace, regions: Int32[np.ndarray, " s"], count: int, least: int, mergeable: int
) -> tuple[Int32[np.ndarray, " s"], int]:
    """Number the regions anew, without those that are too small.

    Args:
        space: Open space, eroded.
        regions: Region of every span.
        count: Number of regions with region 0.
        least: Spans that connected regions must have together to stay.
        mergeable: Spans up to which a region is joined with a neighbour.

    Returns:
        Region of every span and the number of regions without region 0.
    """
    known = _Regions(space, regions, count)
    known.drop_small(least)
    merged = True
    while merged:
        merged = False
        for region in range(1, count):
            if known.sizes[region] == 0 or known.overlaps[region]:
                continue
            if known.sizes[region] > mergeable and 0 in known.borders[region]:
                continue
            target = known.partner(region)
            if target != region and known.join(target, region):
                merged = True
    # Without gaps, in the order of the first of those that were joined.
    order = [region for region in dict.fromkeys(known.ids) if region != 0]
    number = {0: 0} | {region: k + 1 for k, region in enumerate(order)}
    numbers = np.array([number[region] for region in known.ids], dtype=np.int32)
    return numbers[regions], len(order)


def _without_repeats(values: list[int]) -> list[int]:
    """Drop values that equal the next one, around the list, but for the last that is left."""
    k = 0
    while k < len(values) and len(values) > 1:
        if values[k] == values[(k + 1) % len(values)]:
            del values[k]
        else:
            k += 1
    return values
