"""Holes of regions, joined to their outlines by bridges (numba kernels), as ``mergeRegionHoles``.

Corners are rows as in `contour_kernels`.
"""

import numpy as np
from numba import njit

from hypernav.worlds.navmesh.recast.lattice_kernels import (
    is_in_cone,
    is_same,
    squared_gap,
    touches,
)

_NONE = -1


@njit(cache=True, nogil=True)
def join_holes(corners, start, owner, regions):
    """Join all holes.

    Args:
        corners: Corners of all contours.
        start: First corner of every contour, and the number of corners.
        owner: Region of every contour.
        regions: Number of regions.

    Returns:
        Corners, first corner and number of corners of every contour; a joined hole has no corners
        of its own.
    """
    count = len(owner)
    begin, length = start[:-1].copy(), start[1:] - start[:-1]
    is_hole = np.zeros(count, dtype=np.bool_)
    outline = np.full(regions + 1, _NONE, dtype=np.int64)
    for k in range(count):
        is_hole[k] = _runs_back(corners[start[k] : start[k + 1]])
        if not is_hole[k]:
            outline[owner[k]] = k
    for region in range(regions + 1):
        holes = np.flatnonzero(is_hole & (owner == region))
        if len(holes) > 0 and outline[region] != _NONE:
            corners = _join(corners, begin, length, outline[region], holes)
    return corners, begin, length


@njit(cache=True, nogil=True)
def _runs_back(corners):
    """Whether a contour is that of a hole; one with the area of a column or less never is."""
    area = 0
    for k in range(len(corners)):
        area += corners[k, 0] * corners[k - 1, 2] - corners[k - 1, 0] * corners[k, 2]
    return area <= -3


@njit(cache=True, nogil=True)
def _join(corners, begin, length, outline, holes):
    """Join the holes of one outline, from left to right; returns all corners."""
    leftmost = np.zeros(len(holes), dtype=np.int64)
    places = np.zeros(len(holes), dtype=np.int64)
    for k in range(len(holes)):
        first = begin[holes[k]]
        for j in range(1, length[holes[k]]):
            a, b = corners[first + j], corners[first + leftmost[k]]
            if a[0] < b[0] or (a[0] == b[0] and a[2] < b[2]):
                leftmost[k] = j
        corner = corners[first + leftmost[k]]
        places[k] = corner[0] * (1 << 32) + corner[2]
    order = np.argsort(places, kind="mergesort")
    ordered = holes[order]
    nearest = np.zeros(length[outline] + length[holes].sum() + 2 * len(holes), dtype=np.int64)
    for k in range(len(ordered)):
        hole = ordered[k]
        for turn in range(length[hole]):
            best = (leftmost[order[k]] + turn) % length[hole]
            bridge = _bridge(corners, begin, length, outline, ordered, k, best, nearest)
            if bridge != _NONE:
                corners = _bridged(corners, begin, length, outline, hole, bridge, best)
                break
    return corners


@njit(cache=True, nogil=True)
def _bridge(corners, begin, length, outline, holes, k, best, nearest):
    """The nearest corner of the outline that is visible from a corner of a hole."""
    corner = corners[begin[holes[k]] + best]
    count = length[outline]
    line = corners[begin[outline] : begin[outline] + count]
    candidates = np.empty(count, dtype=np.int64)
    gaps = np.empty(count, dtype=np.int64)
    found = 0
    for j in range(count):
        if is_in_cone(line[j - 1], line[j], line[(j + 1) % count], corner):
            candidates[found], gaps[found] = j, squared_gap(line[j], corner)
            found += 1
    order = np.argsort(gaps[:found], kind="mergesort")
    nearest[:found] = candidates[:found][order]
    for j in range(found):
        # Recast always ignores the sides at the k-th nearest corner, whichever corner it tries.
        blocked = _is_blocked(line[nearest[j]], corner, nearest[k], line)
        for other in holes[k:]:
            if not blocked:
                beside = corners[begin[other] : begin[other] + length[other]]
                blocked = _is_blocked(line[nearest[j]], corner, _NONE, beside)
        if not blocked:
            return nearest[j]
    return _NONE


@njit(cache=True, nogil=True)
def _is_blocked(a, b, except_at, line):
    """Whether a contour meets a segment elsewhere than at its ends."""
    for k in range(len(line)):
        after = (k + 1) % len(line)
        if except_at in (k, after):
            continue
        p, q = line[k], line[after]
        if is_same(a, p) or is_same(b, p) or is_same(a, q) or is_same(b, q):
            continue
        if touches(a, b, p, q):
            return True
    return False


@njit(cache=True, nogil=True)
def _bridged(corners, begin, length, outline, hole, at_outline, at_hole):
    """One contour from an outline and a hole, at the end of all corners."""
    parts = np.empty((length[outline] + length[hole] + 2, 4), dtype=np.int64)
    n = 0
    for contour, at in ((outline, at_outline), (hole, at_hole)):
        for k in range(length[contour] + 1):
            parts[n] = corners[begin[contour] + (at + k) % length[contour]]
            n += 1
    begin[outline], length[outline], length[hole] = len(corners), n, 0
    return np.concatenate((corners, parts))
