"""Shortest paths and distances on a grid, any-angle; see `geodesic_kernels` for the method."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int32, Int64, UInt8

from hypernav.core.geometry.grid import has_cell
from hypernav.simulator.worlds.surface.geodesic_kernels import (
    UNITS,
    first_bend,
    propagate,
    vertex_kinds,
)

_NOWHERE = -1


@dataclass(frozen=True, eq=False)
class FreeSpace:
    """The union of the closed free cells of a grid.

    Attributes:
        free: Free cells with one blocked cell all around.
        kinds: Kinds of the lattice points, see `geodesic_kernels.vertex_kinds`.
        cell_m: Side of a cell.
        origin: Lower left corner of the first cell inside the border, metres.
    """

    free: Bool[np.ndarray, "rows columns"]
    kinds: UInt8[np.ndarray, "vertex_rows vertex_columns"]
    cell_m: float
    origin: tuple[float, float]

    @staticmethod
    def of(
        free: Bool[np.ndarray, "rows columns"], cell_m: float, origin: tuple[float, float]
    ) -> "FreeSpace":
        """Prepare a grid; everything outside it is blocked."""
        padded = np.pad(free, 1)
        return FreeSpace(padded, vertex_kinds(padded), cell_m, origin)

    def units(self, points: Float64[np.ndarray, "n 2"]) -> Int64[np.ndarray, "n 2"]:
        """Lattice coordinates of points, strictly inside their cells; may lie outside the grid."""
        cells = (points - np.array(self.origin)) / self.cell_m + 1.0
        corner = np.floor(cells)
        inside = np.clip(np.rint((cells - corner) * UNITS), 1, UNITS - 1)
        return (corner * UNITS + inside).astype(np.int64)

    def metres(self, x: int, y: int) -> tuple[float, float]:
        """The point with these lattice coordinates."""
        return (
            float((x / UNITS - 1.0) * self.cell_m + self.origin[0]),
            float((y / UNITS - 1.0) * self.cell_m + self.origin[1]),
        )

    def is_free(self, points: Int64[np.ndarray, "n 2"]) -> Bool[np.ndarray, "n"]:
        """Whether lattice coordinates lie in a free cell."""
        column, row = points[:, 0] // UNITS, points[:, 1] // UNITS
        inside = has_cell(self.free.shape, row, column)
        return inside & self.free[np.where(inside, row, 0), np.where(inside, column, 0)]

    def distance_field(self, targets: Float64[np.ndarray, "n 2"]) -> "DistanceField":
        """Distance from anywhere to the nearest of many points; blocked points are ignored."""
        return self._field(targets, (_NOWHERE, _NOWHERE))

    def distance(self, start: tuple[float, float], end: tuple[float, float]) -> float:
        """Length of the shortest path, metres; infinite if there is none. Symmetric."""
        return self._field_between(*sorted((start, end))).distance(*max(start, end))

    def shortest_path(
        self, start: tuple[float, float], end: tuple[float, float]
    ) -> list[tuple[float, float]]:
        """Start, bends and end of the shortest path, metres; empty if there is none."""
        path = self._field_between(*sorted((start, end))).path(*max(start, end))
        return path if start > end else path[::-1]

    def _field_between(
        self, target: tuple[float, float], goal: tuple[float, float]
    ) -> "DistanceField":
        units = self.units(np.array([target, goal], dtype=np.float64))
        if not self.is_free(units).all():
            return self._field(np.zeros((0, 2)), (_NOWHERE, _NOWHERE))
        return self._field(np.array([target]), (int(units[1, 0]), int(units[1, 1])))

    def _field(self, targets: Float64[np.ndarray, "n 2"], goal: tuple[int, int]) -> "DistanceField":
        units = self.units(targets)
        units = units[self.is_free(units)]
        cells = (units[:, 1] // UNITS) * self.free.shape[1] + units[:, 0] // UNITS
        order = np.argsort(cells, kind="stable")
        units, cells = np.ascontiguousarray(units[order]), cells[order]
        cell_start = np.searchsorted(cells, np.arange(self.free.size + 1))
        best, root = propagate(self.free, self.kinds, units, *goal)
        return DistanceField(self, units, cell_start, best, root)


@dataclass(frozen=True, eq=False)
class DistanceField:
    """Geodesic distance from any point to the nearest of a set of targets.

    Computed once for its targets; a query then costs microseconds.

    Attributes:
        space: Free space in which paths run.
        targets: Lattice coordinates of the targets, by cell.
        cell_start: First target of every cell.
        best: Distance of every lattice point, in lattice units.
        root: Next bend or target from every lattice point.
    """

    space: FreeSpace
    targets: Int64[np.ndarray, "n 2"]
    cell_start: Int64[np.ndarray, "starts"]
    best: Float64[np.ndarray, "vertices"]
    root: Int32[np.ndarray, "vertices"]

    def distance(self, x: float, y: float, z: float | None = None) -> float:
        """Metres to the nearest target; infinite if no path leads there or no floor is here.

        Args:
            x: x of the point, metres.
            y: y of the point, metres.
            z: Its height, which a space of one storey ignores.
        """
        return self._look(x, y)[0] * self.space.cell_m / UNITS

    def path(self, x: float, y: float, z: float | None = None) -> list[tuple[float, float]]:
        """The path over all bends to the nearest target, metres; empty if there is no path."""
        _, root = self._look(x, y)
        if root < 0:
            return []
        points = [(x, y)]
        width = self.space.kinds.shape[1]
        while root >= len(self.targets):
            vertex = root - len(self.targets)
            points.append(self.space.metres(vertex % width * UNITS, vertex // width * UNITS))
            root = int(self.root[vertex])
        last = self.space.metres(int(self.targets[root, 0]), int(self.targets[root, 1]))
        return points if last == points[-1] else [*points, last]

    def _look(self, x: float, y: float) -> tuple[float, int]:
        here = self.space.units(np.array([[x, y]], dtype=np.float64))
        if not self.space.is_free(here)[0]:
            return math.inf, -1
        distance, root = first_bend(
            self.space.free,
            self.space.kinds,
            self.targets,
            self.cell_start,
            self.best,
            self.root,
            int(here[0, 0]),
            int(here[0, 1]),
        )
        return float(distance), int(root)
