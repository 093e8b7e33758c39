"""Regions that begin (numba kernel), as ``floodRegion`` of Recast."""

from numba import njit


@njit(cache=True, nogil=True)
def flood(neighbours, walkable, distance, regions, gaps, seeds, least, following, stack):
    """Begin a region at every seed that is still free and not beside another region.

    Args:
        neighbours: Span in each of the four directions; negative where there is none.
        walkable: Whether the middle of the robot may be on a span.
        distance: Distance of every span to a border.
        regions: Region of every span, 0 for none; written.
        gaps: Distance of every span to where its region began; written.
        seeds: Spans to begin at, in order.
        least: Spans nearer to a border stay free.
        following: Number of the next region.
        stack: Room for as many spans as there are.

    Returns:
        Number of the next region.
    """
    for seed in seeds:
        if regions[seed] != 0:
            continue
        regions[seed], gaps[seed] = following, 0
        stack[0] = seed
        depth, count = 1, 0
        while depth > 0:
            depth -= 1
            i = stack[depth]
            alone = True
            for direction in range(4):
                beside = neighbours[i, direction]
                if beside < 0 or not walkable[beside]:
                    continue
                corner = neighbours[beside, (direction + 1) & 3]
                if regions[beside] != 0 and regions[beside] != following:
                    alone = False
                if corner >= 0 and regions[corner] != 0 and regions[corner] != following:
                    alone = False
            if not alone:
                regions[i] = 0
                continue
            count += 1
            for direction in range(4):
                beside = neighbours[i, direction]
                if beside < 0 or not walkable[beside]:
                    continue
                if distance[beside] >= least and regions[beside] == 0:
                    regions[beside], gaps[beside] = following, 0
                    stack[depth] = beside
                    depth += 1
        if count > 0:
            following += 1
    return following
