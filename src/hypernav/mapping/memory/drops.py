"""The edges of a floor at which stairs down may begin, and that the robot has not looked at."""

import math
from collections.abc import Sequence

import cv2
import numpy as np
from jaxtyping import Bool, Float64, Int64

from hypernav.core.exploring.floors import Drop
from hypernav.mapping.distance import distance_from
from hypernav.mapping.ground import reach
from hypernav.mapping.memory.connectors import Connector
from hypernav.mapping.memory.memory import Memory
from hypernav.mapping.memory.ways import knows_next_floor

_PATCH_M = 0.2
"""Side of the patches that edges of the floor are made of, metres."""
_EDGE_PATCHES = 2
"""Least number of patches in an edge at which stairs may begin."""
_NEAR_M = 1.5
"""Distance from which the robot sees whether stairs begin at an edge, metres."""
_BEFORE_M = 0.8
"""Distance from stairs, metres, at which a robot stands before them."""
_ALONG = math.radians(30.0)
"""Angle from the direction of stairs up to which it looks along them."""
_IN_SIGHT_M = 8.0
"""Distance from which images hardly show edges, metres."""


def drops_to_look_at(memory: Memory) -> list[Drop]:
    """Where the floor of a climbing robot ends, as it does at the head of stairs.

    From afar images show that floor is missing, but not whether stairs lead down there. What the
    robot has looked at from near is left out, and so are edges at stairs that it knows, up or down,
    and those behind a railing. Stairs down that were seen too seldom to rely on are looked at, too,
    from before them. There are none where it knows a way to the next floor down: most of them are
    the well of these stairs.

    Returns:
        Such stairs, and for each edge the position on it that is nearest to where the robot has
        been.
    """
    if knows_next_floor(memory, memory.floor, goes_up=False):
        return []
    known = [one for one in memory.connectors if one.floor == memory.number]
    stairs = [one for one in known if one.is_doubtful and not one.goes_up]
    touches = _are_in_reach(memory, np.array([one.approach for one in stairs]).reshape(-1, 2))
    edges = [
        Drop(x, y)
        for x, y in _new_edges(memory)
        if all(math.dist((x, y), one.end) > _NEAR_M for one in known)
    ]
    new = [
        Drop(*one.end, one.axis)
        for one, is_in_reach in zip(stairs, touches, strict=True)
        if is_in_reach and not _was_looked_down(memory, one)
    ]
    return new + edges


def _new_edges(memory: Memory) -> list[tuple[float, float]]:
    """For each edge that the robot has not looked at, the position nearest to where it has been."""
    edges = memory.floor.map.edges_to_drops()
    edges = np.unique(np.floor(edges[_are_in_reach(memory, edges)] / _PATCH_M), axis=0)
    patches = edges[~_seen_from_near(memory, _PATCH_M * (edges + 0.5))]
    if len(patches) < _EDGE_PATCHES:
        return []
    been_m = _distances_m(patches, memory.floor.trajectory)
    nearest = [patches[edge[been_m[edge].argmin()]] for edge in _edges(patches)]
    return [(float(_PATCH_M * (x + 0.5)), float(_PATCH_M * (y + 0.5))) for x, y in nearest]


def _was_looked_down(memory: Memory, stairs: Connector) -> bool:
    """Whether the robot has stood before stairs in this search and looked along them."""
    return any(
        one.distance_to(*stairs.end) <= _BEFORE_M
        and math.cos(one.yaw - stairs.axis) >= math.cos(_ALONG)
        for one in memory.search.views
    )


def _seen_from_near(memory: Memory, places: Float64[np.ndarray, "n 2"]) -> Bool[np.ndarray, " n"]:
    """Whether the robot has looked at each of some places, or been near it in an earlier search."""
    been, views = np.array(memory.floor.trajectory).reshape(-1, 2), memory.search.views
    to_x, to_y = (places[:, axis, None] - been[:, axis] for axis in (0, 1))
    looked = np.asarray(np.hypot(to_x, to_y) <= _NEAR_M)
    first = len(been) - len(views)
    off = np.arctan2(to_y, to_x)[:, first:] - [one.yaw for one in views]
    half = math.radians(memory.embodiment.camera.hfov_deg) / 2.0
    looked[:, first:] &= np.cos(off) >= math.cos(half)
    return np.asarray(looked.any(axis=1))


def _are_in_reach(memory: Memory, places: Float64[np.ndarray, "n 2"]) -> Bool[np.ndarray, " n"]:
    """Whether the robot's body could touch each of some places ``(x, y)``, metres."""
    floor, radius_m = memory.floor, memory.embodiment.body.radius_m
    touches = np.zeros(len(places), dtype=bool)
    if len(places) == 0 or not floor.trajectory:
        return touches
    grid = floor.map.grid
    away = distance_from(reach(grid, floor.trajectory[-1], radius_m))
    cells = grid.cells_of(places)
    inside = grid.contains(cells)
    touches[inside] = away[tuple(cells[inside].T)] <= radius_m / grid.resolution_m + 1.0
    return touches


def _distances_m(
    patches: Float64[np.ndarray, "n 2"], positions: Sequence[tuple[float, float]]
) -> Float64[np.ndarray, "n"]:
    """Distance of each patch from the nearest of the positions in sight of any, metres."""
    margin = math.ceil(_IN_SIGHT_M / _PATCH_M)
    first = patches.min(axis=0) - margin
    shape = (patches.max(axis=0) - first).astype(np.int64) + margin + 1
    at = np.floor(np.array(positions).reshape(-1, 2) / _PATCH_M) - first
    at = at[((at >= 0) & (at < shape)).all(axis=1)].astype(np.int64)
    there = np.zeros(shape, dtype=bool)
    there[tuple(at.T)] = True
    away_m = _PATCH_M * distance_from(there)
    return away_m[tuple((patches - first).astype(np.int64).T)].astype(np.float64)


def _edges(patches: Float64[np.ndarray, "n 2"]) -> list[Int64[np.ndarray, "_"]]:
    """Numbers of the patches of each connected edge that may be as long as stairs are wide."""
    if len(patches) == 0:
        return []
    at = (patches - patches.min(axis=0)).astype(np.int64)
    there = np.zeros(at.max(axis=0) + 1, dtype=np.uint8)
    there[tuple(at.T)] = 1
    count, edge_of = cv2.connectedComponents(there, connectivity=8)
    edges = [np.flatnonzero(edge_of[tuple(at.T)] == k) for k in range(1, count)]
    return [edge for edge in edges if len(edge) >= _EDGE_PATCHES]
