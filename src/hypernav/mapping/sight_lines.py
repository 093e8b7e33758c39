"""Lines of sight on the map: the unseen floor along them, and whether they are clear."""

import math

import numpy as np
from jaxtyping import Bool, Float64

from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.mapping.view_kernels import clear_lines

OPEN_M = 3.0
"""Length of unknown floor, metres, after which 1 / e of all lines of sight still go on; ours."""


def unseen_by_bearing(
    grid: OccupancyGrid,
    position: tuple[float, float],
    bearings: Float64[np.ndarray, " n"],
    *,
    nearest_m: float,
    farthest_m: float,
) -> Float64[np.ndarray, " n"]:
    """Unknown floor around a position along lines of sight, which end at obstacles.

    The farther a line has gone through the unknown, the likelier something there has ended it, and
    the less the floor there counts.

    Args:
        grid: The map; beyond it all is unknown.
        position: Position ``(x, y)`` of the camera, ``map`` frame, metres.
        bearings: Directions in the ``map`` frame, radians, spread evenly around the circle.
        nearest_m: Distance of the nearest floor in the camera's image, metres.
        farthest_m: Range of the camera, metres.

    Returns:
        Expected area of unknown floor in sight in the sector of each direction, square metres.
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


def lines_are_clear(
    grid: OccupancyGrid,
    starts: Float64[np.ndarray, "n 2"],
    ends: Float64[np.ndarray, "n 2"],
    *,
    through: Float64[np.ndarray, "m 2"],
) -> Bool[np.ndarray, " n"]:
    """Whether the map shows no obstacle on straight lines.

    Args:
        grid: The map; what is unknown hides nothing.
        starts: Start of every line, ``(x, y)``, ``map`` frame, metres.
        ends: End of every line, ``(x, y)``, metres.
        through: Positions ``(x, y)``, metres, whose cells hide nothing: those of the object.
    """
    lengths = np.linalg.norm(ends - starts, axis=1)
    samples = math.ceil(1.5 * float(lengths.max(initial=0.0)) / grid.resolution_m) + 1
    return clear_lines(
        grid.cells,
        grid.mask_of(through),
        np.array(grid.origin),
        grid.resolution_m,
        starts,
        ends - starts,
        np.linspace(0.0, 1.0, samples),
    )
