"""Distances to obstacles: from a map, or from points that a camera has measured."""

from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float64
from scipy.spatial import KDTree

from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.mapping.inflation import distance_from


@runtime_checkable
class Obstacles(Protocol):
    """Obstacles around the robot, in the frame of its path."""

    def distances(self, points: Float64[np.ndarray, "n 2"]) -> Float64[np.ndarray, " n"]:
        """Distance of every point ``(x, y)`` to the nearest obstacle, metres; 0 inside one."""
        ...


class NoObstacles:
    """No obstacles at all."""

    def distances(self, points: Float64[np.ndarray, "n 2"]) -> Float64[np.ndarray, " n"]:
        """Infinity for every point."""
        return np.full(len(points), np.inf)


class MapObstacles:
    """The occupied cells of a map; unknown cells and those beyond the map count as free."""

    def __init__(self, grid: OccupancyGrid) -> None:
        """Measure the distances in a map, which may change afterwards."""
        self._grid = grid
        cells = distance_from(grid.occupied)
        self._distances = cells.astype(np.float64) * grid.resolution_m

    def distances(self, points: Float64[np.ndarray, "n 2"]) -> Float64[np.ndarray, " n"]:
        """Distance from every point's cell to the nearest occupied one, between centres, metres."""
        cells = self._grid.cells_of(points)
        inside = self._grid.contains(cells)
        found = np.full(len(points), np.inf)
        found[inside] = self._distances[cells[inside, 0], cells[inside, 1]]
        return found


class PointObstacles:
    """Points that a camera has measured."""

    def __init__(self, points: Float64[np.ndarray, "n 2"]) -> None:
        """Take points ``(x, y)`` of obstacles, metres; there may be none."""
        self._tree = KDTree(points) if len(points) else None

    def distances(self, points: Float64[np.ndarray, "n 2"]) -> Float64[np.ndarray, " n"]:
        """Distance of every point to the nearest measured one, metres."""
        if self._tree is None:
            return np.full(len(points), np.inf)
        return np.asarray(self._tree.query(points)[0], dtype=np.float64)
