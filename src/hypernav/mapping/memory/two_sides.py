"""Tells two things on both sides of a wall from one thing that was seen from two sides."""

import math

import cv2
import numpy as np
from jaxtyping import Int32

from hypernav.core.geometry.grid import Cell, OccupancyGrid, has_cell
from hypernav.mapping.memory.thing import SAME_SIDE, Thing
from hypernav.mapping.top_down.top_down_map import TopDownMap

_BESIDE_M = 0.6
"""Distance beside two things, metres, within which a wall between them must have no end."""


def is_wall_between(one: Thing, other: Thing, floor_map: TopDownMap) -> bool:
    """Whether a known wall parts all lines of sight to one thing from those to another.

    Around what stands free, however tall it is, the map shows a way from one line of sight to the
    other; so it does where the wall is not known to go on beside the things.

    Args:
        one: A thing.
        other: A thing in the same place, or right beside it.
        floor_map: Map of their floor.
    """
    if _is_seen_from_one_side(one, other):
        return False
    corners = np.array([(*thing.low[:2], *thing.high[:2]) for thing in (one, other)])
    low, high = corners[:, :2].min(axis=0), corners[:, 2:].max(axis=0)
    reach_m = float((high - low).max()) / 2.0 + _BESIDE_M
    middle = (low + high) / 2.0
    around = np.array([middle - reach_m, middle + reach_m])
    grid = floor_map.eye_level(around)
    (bottom, left), (top, right) = np.maximum(grid.cells_of(around), 0).tolist()
    is_open = grid.cells[bottom : top + 1, left : right + 1] != Cell.OCCUPIED
    parts = cv2.connectedComponents(is_open.view(np.uint8), connectivity=4)[1]
    sides = [_parts_in_sight(thing, grid, parts, (bottom, left)) for thing in (one, other)]
    return all(sides) and sides[0].isdisjoint(sides[1])


def _is_seen_from_one_side(one: Thing, other: Thing) -> bool:
    """As `Thing.was_seen_from`, much faster for so few views."""
    x, y, _ = one.position
    return any(
        (a - x) * (c - x) + (b - y) * (d - y)
        >= SAME_SIDE * math.hypot(a - x, b - y) * math.hypot(c - x, d - y)
        for a, b, _ in one.views
        for c, d, _ in other.views
    )


def _parts_in_sight(
    thing: Thing,
    grid: OccupancyGrid,
    parts: Int32[np.ndarray, "rows columns"],
    corner: tuple[int, int],
) -> set[int]:
    """The parts of a map that the lines of sight to a thing lie in, before they end at an obstacle.

    Args:
        thing: The thing.
        grid: The map.
        parts: Number of the part of each cell around the thing; 0 where an obstacle is.
        corner: Row and column of the first of these cells in the map.
    """
    middle, found = np.array(thing.position[:2]), set[int]()
    for view in np.array(thing.views)[:, :2]:
        length_m = math.dist(view, middle)
        samples = math.ceil(2.0 * length_m / grid.resolution_m) + 1
        line = view + np.linspace(0.0, 1.0, samples)[:, None] * (middle - view)
        cells = grid.cells_of(line) - corner
        along = parts[tuple(cells[has_cell(parts.shape, *cells.T)].T)]
        is_end = along == 0
        found |= set(along[: int(is_end.argmax()) if is_end.any() else None].tolist())
    return found
