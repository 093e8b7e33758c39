"""The edges of a floor before stairs, and those of stairwells at which none begin."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Float64

from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.mapping.ground import Ground
from hypernav.mapping.memory.connectors import Connector, Passage
from hypernav.mapping.memory.seen_connectors import LEVEL_M, shows_steps

EDGE_M = 1.5
"""Distance to both sides of the end of stairs, metres, in which their edge is looked for."""
_BEFORE_EDGE_M, _BEYOND_EDGE_M = 0.15, 0.3
"""Distances before and beyond it at which there is floor, and none."""
_HEADROOM_M = np.arange(0.5, 1.5, 0.05)
"""Distances beyond the head of stairs down, metres, at which nothing is above them."""
_ACROSS_M = np.arange(-0.3, 0.3, 0.05)
"""Distances to the left of their axis, metres, that are looked at there."""
_MOST_CLOSED = 0.35
"""Share of these that may be floor or wall."""


def without_sides(
    known: Sequence[Connector], floor: int, ground: Ground, floor_z: float, grid: OccupancyGrid
) -> tuple[Connector, ...]:
    """The known connectors, of which none counts that is the side of a stairwell.

    It is an edge of the floor, too, but no steps were seen there, and soon beyond it there is floor
    again, or a wall: the floor above a flight is open until people can walk below it. Such a one is
    neither relied on nor looked at until new images show it as stairs.

    Args:
        known: The connectors.
        floor: Number of the robot's floor.
        ground: Ground around the robot.
        floor_z: Height of its floor, metres.
        grid: Map of that floor.
    """
    return tuple(
        replace(one, sightings=0)
        if one.floor == floor
        and one.passage is Passage.UNTRIED
        and not one.goes_up
        and sum(edge_beside(ground, one, floor_z)) > 0.0
        and not shows_steps(ground, one, floor_z)
        and not _has_headroom(one, ground, floor_z, grid)
        else one
        for one in known
    )


def edge_beside(ground: Ground, one: Connector, floor_z: float) -> tuple[float, float]:
    """How far the edge between floor and steps goes on to the left and right of its end, metres.

    At most `EDGE_M` to each side; 0 to both where there is none.
    """
    ahead = np.array([math.cos(one.axis), math.sin(one.axis)])
    left = np.array([-ahead[1], ahead[0]])
    beside_m = np.arange(0.0, EDGE_M, ground.grid.resolution_m)
    reach_m = [0.0, 0.0]
    for side, sign in enumerate((1.0, -1.0)):
        edge = np.array(one.end) + sign * beside_m[:, None] * left
        before, beyond = edge - _BEFORE_EDGE_M * ahead, edge + _BEYOND_EDGE_M * ahead
        is_edge = ground.grid.picked(ground.reached, before)
        is_edge &= ground.grid.picked(ground.grid.free, beyond) & ~_is_floor(
            ground, beyond, floor_z
        )
        reach_m[side] = float(beside_m[-1] if is_edge.all() else beside_m[is_edge.argmin()])
    return reach_m[0], reach_m[1]


def _has_headroom(down: Connector, ground: Ground, floor_z: float, grid: OccupancyGrid) -> bool:
    """Whether neither floor nor wall lies across the way, right beyond the end of stairs down."""
    cos, sin = math.cos(down.axis), math.sin(down.axis)
    x = down.end[0] + _HEADROOM_M[:, None] * cos - _ACROSS_M * sin
    y = down.end[1] + _HEADROOM_M[:, None] * sin + _ACROSS_M * cos
    points = np.stack([x.ravel(), y.ravel()], axis=1)
    is_closed = grid.picked(grid.cells, points) == Cell.OCCUPIED
    is_closed |= _is_floor(ground, points, floor_z)
    return bool((is_closed.reshape(x.shape).mean(axis=1) <= _MOST_CLOSED).all())


def _is_floor(
    ground: Ground, points: Float64[np.ndarray, "n 2"], floor_z: float
) -> Bool[np.ndarray, " n"]:
    """Whether ground at a floor's height was seen at positions ``(x, y)``, metres."""
    with np.errstate(invalid="ignore"):
        is_level = np.abs(ground.grid.picked(ground.measured, points) - floor_z) <= LEVEL_M
    return ground.grid.picked(ground.seen, points) & is_level
