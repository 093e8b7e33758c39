"""The order of visits that shows the unknown soonest, compiled."""

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def unseen_after(areas, shows):
    """What is still unseen after every set of stops; bit k of a set's number is stop k.

    Args:
        areas: float64 (areas,), sizes of parts of the unknown, in any unit, such as m².
        shows: bool (stops, areas), whether a stop shows a part.

    Returns:
        float64 (2**stops,): by set, sum of the areas that some stop shows, but none of the set.
    """
    stops = len(shows)
    sets = 1 << stops
    seen_only_by = np.zeros(sets)
    for i in range(areas.size):
        seen_from = 0
        for stop in range(stops):
            if shows[stop, i]:
                seen_from |= 1 << stop
        seen_only_by[seen_from] += areas[i]
    seen_only_by[0] = 0.0
    # Sums over all subsets, one stop after the other.
    for stop in range(stops):
        for one in range(sets):
            if one >> stop & 1:
                seen_only_by[one] += seen_only_by[one ^ (1 << stop)]
    return seen_only_by[::-1].copy()


@njit(cache=True, nogil=True)
def soonest_tour(first, legs, unseen):
    """The open tour that sees things soonest, exactly.

    Every metre costs what is unseen while it is driven, so that the sum is proportional to the mean
    path until a thing is seen that is equally likely anywhere in the unseen areas.

    Args:
        first: float64 (stops,), lengths of the paths from the robot, metres.
        legs: float64 (stops, stops), lengths of the paths between stops, metres.
        unseen: float64 (2**stops,), what is still unseen after every set of stops.

    Returns:
        int64 (stops,): numbers of the stops in the order of the tour.
    """
    stops = first.size
    sets = 1 << stops
    cost = np.full((sets, stops), np.inf)
    before = np.empty((sets, stops), dtype=np.int64)
    for stop in range(stops):
        cost[1 << stop, stop] = first[stop] * unseen[0]
    for done in range(1, sets):
        for last in range(stops):
            so_far = cost[done, last]
            if so_far == np.inf:
                continue
            for stop in range(stops):
                if done >> stop & 1:
                    continue
                more = so_far + legs[last, stop] * unseen[done]
                then = done | 1 << stop
                if more < cost[then, stop]:
                    cost[then, stop] = more
                    before[then, stop] = last
    order = np.empty(stops, dtype=np.int64)
    done = sets - 1
    last = int(np.argmin(cost[done]))
    for i in range(stops - 1, -1, -1):
        order[i] = last
        last, done = before[done, last], done ^ 1 << last
    return order
