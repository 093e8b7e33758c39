"""Regions joined with their neighbours, or dropped, where they are small.

As ``mergeAndFilterRegions``.
"""

import numpy as np
from jaxtyping import Int32

from hypernav.worlds.navmesh.recast.regions.outlines import Outlines
from hypernav.worlds.navmesh.recast.voxels.filters import columns_of
from hypernav.worlds.navmesh.recast.voxels.open_space import OpenSpace

_LARGEST = 0xFFFFFFF


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
