"""Holes of regions, joined to their outlines by bridges, as ``mergeRegionHoles``."""

import numpy as np

from hypernav.worlds.navmesh.recast.polygons.contours import Contour, Corner, Corners
from hypernav.worlds.navmesh.recast.polygons.lattice import (
    is_in_cone,
    is_same,
    squared_gap,
    touches,
)


def join_holes(contours: list[Contour]) -> list[Contour]:
    """Join all holes.

    Returns:
        The contours; a hole has no corners left, unless no bridge to it was found.
    """
    joined = list(contours)
    outline = {}
    holes: dict[int, list[int]] = {}
    for k, contour in enumerate(contours):
        if _runs_back(contour.corners):
            holes.setdefault(contour.region, []).append(k)
        else:
            outline[contour.region] = k
    for region in sorted(holes.keys() & outline.keys()):
        _join(joined, outline[region], holes[region])
    return joined


def _runs_back(corners: Corners) -> bool:
    """Whether a contour is a hole's; one of a single column's area, or less, never is."""
    x, z = corners[:, 0], corners[:, 2]
    return bool((x * np.roll(z, 1) - np.roll(x, 1) * z).sum() <= -3)


def _join(contours: list[Contour], outline: int, holes: list[int]) -> None:
    """Join the holes of one outline, from left to right."""
    region = contours[outline].region
    places = {hole: contours[hole].corners[:, [0, 2]].tolist() for hole in holes}
    leftmost = {hole: places[hole].index(min(places[hole])) for hole in holes}
    ordered = sorted(holes, key=lambda hole: places[hole][leftmost[hole]])
    nearest: list[int] = []
    for k, hole in enumerate(ordered):
        beside = [contours[other].corners for other in ordered[k:]]
        line, corners = contours[outline].corners, contours[hole].corners
        for turn in range(len(corners)):
            at = (leftmost[hole] + turn) % len(corners)
            bridge = _bridge(line, corners[at], beside, k, nearest)
            if bridge is not None:
                parts = np.concatenate([_around(line, bridge), _around(corners, at)])
                contours[outline] = Contour(parts, region)
                contours[hole] = Contour(corners[:0], region)
                break


def _around(corners: Corners, first: int) -> Corners:
    """A whole turn, with the first corner at its end again."""
    return np.concatenate([corners[first:], corners[: first + 1]])


def _bridge(
    line: Corners, corner: Corner, holes: list[Corners], k: int, nearest: list[int]
) -> int | None:
    """The nearest corner of the outline that is seen from a corner of a hole.

    Args:
        line: The outline.
        corner: The corner.
        holes: The hole and those that are not joined yet.
        k: How many have been looked at before.
        nearest: What was found for the corners before this one; written over.
    """
    visible = is_in_cone(np.roll(line, 1, axis=0), line, np.roll(line, -1, axis=0), corner)
    candidates = np.flatnonzero(visible)
    order = np.argsort(squared_gap(line[candidates], corner), kind="stable")
    found = candidates[order].tolist()
    nearest[: len(found)] = found
    # Recast leaves out the sides at the k-th nearest corner, whichever corner it tries.
    left_out = nearest[k] if k < len(nearest) else 0
    for at in found:
        if not _is_blocked(line[at], corner, line, left_out) and not any(
            _is_blocked(line[at], corner, hole, None) for hole in holes
        ):
            return at
    return None


def _is_blocked(a: Corner, b: Corner, line: Corners, except_at: int | None) -> bool:
    """Whether a contour meets a segment elsewhere than at its ends."""
    after = np.roll(line, -1, axis=0)
    at_end = is_same(line, a) | is_same(line, b)
    counts = ~(at_end | np.roll(at_end, -1))
    if except_at is not None:
        counts[[except_at, except_at - 1]] = False
    return bool((counts & touches(a, b, line, after)).any())
