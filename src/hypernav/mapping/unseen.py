"""Floor that was not seen yet and that a camera would look over, by direction."""

import math

import numpy as np
from jaxtyping import Float64

from hypernav.core.geometry.grid import Cell, OccupancyGrid

OPEN_M = 3.0
"""Length of unknown floor after which 1 / e of all lines of sight met no wall yet, metres; ours."""


def unseen_by_bearing(
    grid: OccupancyGrid,
    position: tuple[float, float],
    bearings: Float64[np.ndarray, " n"],
    *,
    nearest_m: float,
    farthest_m: float,
) -> Float64[np.ndarray, " n"]:
    """Unknown floor around a position along lines of sight, which end at obstacles.

    The farther a line goes through the unknown, the likelier something there ends it, and the less
    it counts.

    Args:
        grid: The map; beyond it all is unknown.
        position: Position ``(x, y)`` of the camera, metres.
        bearings: Directions in the ``map`` frame, radians, spread evenly around the circle.
        nearest_m: Distance of the nearest floor in the camera's image, metres.
        farthest_m: Range of the camera, metres.

    Returns:
        Area of the unknown floor in the sector around each direction, square metres.
    """
    spacing_m = grid.resolution_m
    along = np.arange(spacing_m / 2.0, farthest_m, spacing_m)
    away = along[:, None] * np.stack([np.cos(bearings), np.sin(bearings)])[:, None]
    points = np.array(position)[:, None, None] + away
    cells = grid.cells_of(points.reshape(2, -1).T)
    inside = grid.contains(cells)
    states = np.full(len(cells), Cell.UNKNOWN, dtype=np.uint8)
    states[inside] = grid.cells[cells[inside, 0], cells[inside, 1]]
    states = states.reshape(len(along), len(bearings))
    in_sight = np.cumsum(states == Cell.OCCUPIED, axis=0) == 0
    unknown = in_sight & (states == Cell.UNKNOWN)
    chance = np.exp(-np.cumsum(unknown, axis=0) * (spacing_m / OPEN_M))
    areas = np.where(along >= nearest_m, along, 0.0) * spacing_m * (2.0 * math.pi / len(bearings))
    return (unknown * chance * areas[:, None]).sum(axis=0)
