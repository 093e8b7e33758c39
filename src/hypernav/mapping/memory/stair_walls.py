"""The walls and railings beside stairs, which tell their direction."""

import math
from dataclasses import replace
from functools import lru_cache

import cv2
import numpy as np
from jaxtyping import Float64

from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import wrap_angle
from hypernav.mapping.memory.connectors import Connector

_WALLS_M = 2.0
"""Distance from the end of stairs, metres, within which walls and railings tell their direction."""
_BESIDE_M = (0.2, 1.3)
"""Distances from the middle line of stairs, metres, between which what stands beside them lies."""
_LEAST_SIDE_M = 0.4
"""Length of a straight line of it, metres, from which it counts."""
_STANDS_OUT = 1.3
"""Length of the lines on both sides, by that in any other direction, from which they count."""
_SAME_DEG = 10
"""Difference, degrees, up to which a direction is no other one."""


def along_walls(one: Connector, grid: OccupancyGrid) -> Connector:
    """A connector with the direction of the walls and railings on both sides of it.

    Many images show these, while the first edge of stairs is often seen from one side, askew. A
    wall on one side alone may be one that the stairs are not parallel to. Where nothing straight
    stands on both sides, or it does in more than one direction, the connector stays as it is.

    Args:
        one: The connector. Its direction may be wrong by right angles; it keeps these.
        grid: Map of its floor.
    """
    left, right = _beside(one.end, grid)
    both = np.where(np.minimum(left, right) >= _LEAST_SIDE_M, np.sqrt(left * right), 0.0)
    both = both.reshape(2, 90).max(axis=0)
    best = int(both.argmax())
    is_other = np.abs((np.arange(90) - best + 45) % 90 - 45) > _SAME_DEG
    if both[best] <= _STANDS_OUT * both[is_other].max():
        return one
    angle = math.radians(best)
    quarters = round((one.axis - angle) / (math.pi / 2.0))
    return replace(one, axis=wrap_angle(angle + quarters * math.pi / 2.0))


def _beside(end: tuple[float, float], grid: OccupancyGrid) -> Float64[np.ndarray, "sides=2 180"]:
    """Longest straight lines of walls to the left and right of stairs that lead in each direction.

    The directions are 0 to 179 degrees; the lengths are in metres.
    """
    reach = math.ceil(_WALLS_M / grid.resolution_m) + 2
    row, column = grid.cell_of(*end)
    corner = np.maximum((row - reach, column - reach), 0)
    part = grid.cells[corner[0] : max(row + reach, 0), corner[1] : max(column + reach, 0)]
    walls = part == Cell.OCCUPIED
    is_inside = cv2.erode(walls.view(np.uint8), np.ones((3, 3), np.uint8)) > 0  # as in steps up
    away = grid.centres_of(np.argwhere(walls & ~is_inside) + corner) - end
    away = away[np.linalg.norm(away, axis=1) <= _WALLS_M]
    return _lines(away.tobytes(), grid.resolution_m)


@lru_cache(maxsize=8)
def _lines(walls: bytes, side_m: float) -> Float64[np.ndarray, "sides=2 180"]:
    """The lines beside stairs, kept: these are asked for in every step of a climb.

    Args:
        walls: Positions ``(x, y)`` of their cells from the end of the stairs, float64, metres.
        side_m: Side of a cell, metres.
    """
    away = np.frombuffer(walls).reshape(-1, 2)
    angles = np.radians(np.arange(180.0))
    to_left_m = away @ np.stack([-np.sin(angles), np.cos(angles)])
    nearest, farthest = (round(one / side_m) for one in _BESIDE_M)
    line = np.floor(to_left_m / side_m).astype(np.int64) + farthest
    is_beside = (line >= 0) & (line < 2 * farthest)
    line += 2 * farthest * np.arange(180)
    cells = np.bincount(line[is_beside], minlength=180 * 2 * farthest).reshape(180, 2 * farthest)
    right, left = cells[:, : farthest - nearest], cells[:, farthest + nearest :]
    lines = np.stack([left.max(axis=1), right.max(axis=1)]) * side_m
    lines.flags.writeable = False  # the kept ones
    return lines
