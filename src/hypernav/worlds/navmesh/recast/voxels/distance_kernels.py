"""Distances in the open space (numba kernel), as ``calculateDistanceField`` of Recast."""

from numba import njit

_STRAIGHT, _DIAGONAL = 2, 3


@njit(cache=True, nogil=True)
def spread(neighbours, distance):
    """Lower every distance to those of neighbours and of diagonal ones, there and back again.

    Args:
        neighbours: Span in each of the four directions; negative where there is none.
        distance: Distances, in half columns; written anew.
    """
    count = len(distance)
    for way in range(2):
        for n in range(count):
            i = count - 1 - n if way else n
            own = distance[i]
            for k in range(2):
                direction = (2 * way + 3 * k) & 3
                beside = neighbours[i, direction]
                if beside >= 0:
                    own = min(own, distance[beside] + _STRAIGHT)
                    corner = neighbours[beside, (direction + 3) & 3]
                    if corner >= 0:
                        own = min(own, distance[corner] + _DIAGONAL)
            distance[i] = own
