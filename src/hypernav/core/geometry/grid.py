"""Occupancy grids: ``[row, column]``, row along y, column along x, cell (0, 0) lower left."""

from dataclasses import dataclass, replace
from enum import IntEnum
from typing import overload

import numpy as np
from jaxtyping import Bool, Float, Float64, Int64, Shaped, UInt8


class Cell(IntEnum):
    """State of one cell of the map."""

    UNKNOWN = 0
    FREE = 1
    OCCUPIED = 2


@dataclass(frozen=True, eq=False)
class OccupancyGrid:
    """The map at one moment.

    Cell indices change when the map grows, so positions kept between steps are in metres.

    Attributes:
        cells: States of the cells, values of `Cell`.
        resolution_m: Side of a cell, metres.
        origin: Lower left corner of cell (0, 0), metres, in the ``map`` frame.
    """

    cells: UInt8[np.ndarray, "rows columns"]
    resolution_m: float
    origin: tuple[float, float]

    def copy(self) -> "OccupancyGrid":
        """A copy that does not change with the map."""
        return replace(self, cells=self.cells.copy())

    @property
    def free(self) -> Bool[np.ndarray, "rows columns"]:
        """Free cells, where the robot may be."""
        return self.cells == Cell.FREE

    @property
    def free_m2(self) -> float:
        """Area of the free cells, square metres."""
        return float(np.count_nonzero(self.free)) * self.resolution_m**2

    @property
    def occupied(self) -> Bool[np.ndarray, "rows columns"]:
        """Occupied cells, where obstacles are."""
        return self.cells == Cell.OCCUPIED

    @property
    def explored(self) -> Bool[np.ndarray, "rows columns"]:
        """Free and occupied cells."""
        return self.cells != Cell.UNKNOWN

    def cell_of(self, x: float, y: float) -> tuple[int, int]:
        """The ``(row, column)`` that holds a point; may lie outside the grid."""
        return (
            int(np.floor((y - self.origin[1]) / self.resolution_m)),
            int(np.floor((x - self.origin[0]) / self.resolution_m)),
        )

    def cells_of(self, points: Float[np.ndarray, "n 2"]) -> Int64[np.ndarray, "n 2"]:
        """``[row, column]`` of every ``(x, y)``; may lie outside the grid."""
        cells = np.floor((points - np.array(self.origin)) / self.resolution_m).astype(np.int64)
        return cells[:, ::-1]

    def centre_of(self, row: int, column: int) -> tuple[float, float]:
        """``(x, y)`` of a cell's middle, metres."""
        return (
            self.origin[0] + (column + 0.5) * self.resolution_m,
            self.origin[1] + (row + 0.5) * self.resolution_m,
        )

    def centres_of(self, cells: Int64[np.ndarray, "n 2"]) -> Float64[np.ndarray, "n 2"]:
        """``(x, y)`` of every ``[row, column]``, metres."""
        return np.array(self.origin) + (cells[:, ::-1] + 0.5) * self.resolution_m

    def inside(self, row: int, column: int) -> bool:
        """Whether the grid has this cell."""
        return has_cell(self.cells.shape, row, column)

    def contains(self, cells: Int64[np.ndarray, "n 2"]) -> Bool[np.ndarray, " n"]:
        """Which ``[row, column]`` lie in the grid."""
        return has_cell(self.cells.shape, *cells.T)

    def mask_of(self, points: Float[np.ndarray, "n 2"]) -> Bool[np.ndarray, "rows columns"]:
        """The cells that hold some ``(x, y)``; points outside the grid are left out."""
        cells = self.cells_of(points)
        rows, columns = cells[self.contains(cells)].T
        mask = np.zeros(self.cells.shape, dtype=bool)
        mask[rows, columns] = True
        return mask

    def picked(
        self, values: Shaped[np.ndarray, "rows columns"], points: Float[np.ndarray, "n 2"]
    ) -> Shaped[np.ndarray, " n"]:
        """The values that the cells have at every ``(x, y)``; zero, or False, outside the grid."""
        cells = self.cells_of(points)
        inside = self.contains(cells)
        picked = np.zeros(len(cells), dtype=values.dtype)
        picked[inside] = values[tuple(cells[inside].T)]
        return picked

    def state_at(self, x: float, y: float) -> Cell:
        """State of the cell that holds a point; unknown outside the grid."""
        row, column = self.cell_of(x, y)
        return Cell(self.cells[row, column]) if self.inside(row, column) else Cell.UNKNOWN

    def cropped(self, margin_m: float = 0.5) -> "OccupancyGrid":
        """The explored part with a margin around it; at least one cell."""
        # Unknown is 0, so a maximum is enough; it is many times faster than building a mask.
        rows = np.flatnonzero(self.cells.max(axis=1, initial=Cell.UNKNOWN))
        columns = np.flatnonzero(self.cells.max(axis=0, initial=Cell.UNKNOWN))
        if rows.size == 0:
            return OccupancyGrid(self.cells[:1, :1], self.resolution_m, self.origin)
        margin = int(np.ceil(margin_m / self.resolution_m))
        row, column = max(rows[0] - margin, 0), max(columns[0] - margin, 0)
        cells = self.cells[row : rows[-1] + 1 + margin, column : columns[-1] + 1 + margin]
        origin = (
            self.origin[0] + float(column) * self.resolution_m,
            self.origin[1] + float(row) * self.resolution_m,
        )
        return OccupancyGrid(cells, self.resolution_m, origin)


@overload
def is_within(index: float, end: float) -> bool: ...
@overload
def is_within(index: Shaped[np.ndarray, "*n"], end: float) -> Bool[np.ndarray, "*n"]: ...
def is_within(index, end):
    """Whether an index or coordinate lies in ``[0, end)``; NaN does not."""
    return (index >= 0) & (index < end)


@overload
def has_cell(shape: tuple[int, ...], row: int, column: int) -> bool: ...
@overload
def has_cell(
    shape: tuple[int, ...], row: Shaped[np.ndarray, "*n"], column: Shaped[np.ndarray, "*n"]
) -> Bool[np.ndarray, "*n"]: ...
def has_cell(shape, row, column):
    """Whether an array of this shape, ``(rows, columns)``, has a cell (or each of several)."""
    return is_within(row, shape[0]) & is_within(column, shape[1])
