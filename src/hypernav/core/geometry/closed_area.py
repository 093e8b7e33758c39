"""Places that a robot is told not to enter, although its map shows them as free."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from hypernav.core.geometry.grid import Cell, OccupancyGrid


@dataclass(frozen=True)
class ClosedArea:
    """A disc on a floor that the robot is not to enter.

    Attributes:
        floor: Number of the floor, from 1.
        x: Middle along the x axis, ``map`` frame, metres.
        y: Middle along the y axis, ``map`` frame, metres.
        radius_m: Radius, metres.
    """

    floor: int
    x: float
    y: float
    radius_m: float

    def distance_m(self, x: float, y: float) -> float:
        """Distance of a point from the edge, metres; negative inside."""
        return float(np.hypot(x - self.x, y - self.y)) - self.radius_m


def with_closed(grid: OccupancyGrid, areas: Iterable[ClosedArea]) -> OccupancyGrid:
    """The map of a floor with areas of that floor as obstacles; the map itself if there are none.

    Cells outside the map stay outside: a map that grows shows more of an area the next time.
    """
    closed = tuple(areas)
    if not closed:
        return grid
    cells, size = grid.cells.copy(), grid.resolution_m
    rows, columns = cells.shape
    x = grid.origin[0] + (np.arange(columns) + 0.5) * size
    y = grid.origin[1] + (np.arange(rows) + 0.5) * size
    for area in closed:
        # A cell that the disc only touches belongs to it.
        reach = area.radius_m + 0.5 * size
        away = np.hypot(x[np.newaxis, :] - area.x, y[:, np.newaxis] - area.y)
        cells[away <= reach] = Cell.OCCUPIED
    return replace(grid, cells=cells)
