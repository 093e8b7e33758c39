"""Distances from a map's obstacles, their inflation by the robot's size, and escapes from it."""

import math
from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float32, UInt8

from hypernav.core.geometry.grid import has_cell
from hypernav.search.mapping.grid_kernels import nearest_open_cell, travel_cells

_WITHIN_M = 1.0
"""Distance in rows and columns, metres, within which an open cell is looked for."""
_WIDTH_CELLS = 1.5
"""Cells by which an escape may exceed the shortest one, since the robot's steps are long."""


def distance_from(
    mask: Bool[np.ndarray, "rows columns"],
) -> Float32[np.ndarray, "rows columns"]:
    """Distance of every cell from the nearest cell of a mask, between middles, cells.

    Where the mask has no cell it is infinite. The same mask gives the same bytes, at distances up
    to 4,000 cells: OpenCV's own result errs by up to 4e-6 cells, with Intel's library differently
    at every address in memory, so that of two equally near cells either might be the nearer one.
    """
    if not mask.any():
        return np.full(mask.shape, np.inf, np.float32)
    nearly = cv2.distanceTransform((~mask).view(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    # The square of a distance between cells is a whole number.
    return np.sqrt(np.rint(np.square(nearly, dtype=np.float64))).astype(np.float32)


def joined_to(
    start: tuple[int, int], mask: Bool[np.ndarray, "rows columns"]
) -> Bool[np.ndarray, "rows columns"]:
    """The cells of a mask to which others of it lead, side by side, from one of them."""
    cells = mask.astype(np.uint8)
    cv2.floodFill(cells, None, start[::-1], 2, flags=4)
    return cells == 2


def disc(radius_m: float, cell_size_m: float) -> UInt8[np.ndarray, "side side"]:
    """Structuring element: 1 for cells whose middles lie within a radius of the middle cell's."""
    radius = radius_m / cell_size_m
    reach = math.floor(radius + 1e-9)
    squared = np.arange(-reach, reach + 1) ** 2
    return (squared[:, None] + squared[None, :] <= radius**2 + 1e-9).astype(np.uint8)


def inflate(
    cells: Bool[np.ndarray, "rows columns"] | UInt8[np.ndarray, "rows columns"],
    radius_m: float,
    cell_size_m: float,
    *,
    outside: bool = False,
) -> UInt8[np.ndarray, "rows columns"]:
    """Mask of the cells within a radius of the given ones, those included: 1, and 0 elsewhere.

    Args:
        cells: Mask of the given cells, not 0.
        radius_m: Distance between middles of cells, metres.
        cell_size_m: Side of a cell, metres.
        outside: Whether everything outside the grid is given too.
    """
    return cv2.dilate(
        cells.astype(np.uint8),
        disc(radius_m, cell_size_m),
        borderType=cv2.BORDER_CONSTANT,
        borderValue=int(outside),
    )


@dataclass(frozen=True, eq=False)
class Escape:
    """Path to open floor from a cell where the robot should not be.

    Attributes:
        exit: Nearest open cell ``(row, column)``.
        cells: Mask of the cells around the robot that are hardly farther away than the exit.
    """

    exit: tuple[int, int]
    cells: Bool[np.ndarray, "rows columns"]

    @staticmethod
    def find(
        occupied: Bool[np.ndarray, "rows columns"],
        is_open: UInt8[np.ndarray, "rows columns"],
        here: tuple[int, int],
        cell_size_m: float,
    ) -> "Escape | None":
        """Look for an escape between the obstacles or, if they leave none, across them.

        So an open cell behind a thin wall is taken only if no other one can be reached.

        Args:
            occupied: Mask of the obstacles, not inflated.
            is_open: Mask of the cells where the robot may be: 1, and 0 elsewhere.
            here: Cell of the robot, ``(row, column)``.
            cell_size_m: Side of a cell, metres.

        Returns:
            The escape, without cells if the robot stands in the open; None if no open cell is near,
            or if the robot is off the map.
        """
        row, column = here
        if not has_cell(occupied.shape, row, column):
            return None
        cells = np.zeros(occupied.shape, dtype=bool)
        if is_open[row, column]:
            return Escape((row, column), cells)
        within = round(_WITHIN_M / cell_size_m)
        bottom, left = max(row - within, 0), max(column - within, 0)
        window = (slice(bottom, row + within + 1), slice(left, column + within + 1))
        for passable in (~occupied[window], np.ones_like(occupied[window])):
            passable[row - bottom, column - left] = True
            travel = travel_cells(passable.view(np.uint8), row - bottom, column - left)
            travel_to_open = np.where(is_open[window] > 0, travel, np.inf)
            nearest = np.unravel_index(int(travel_to_open.argmin()), travel.shape)
            if np.isfinite(travel_to_open[nearest]):
                cells[window] = travel <= travel[nearest] + _WIDTH_CELLS
                return Escape((int(nearest[0]) + bottom, int(nearest[1]) + left), cells)
        return None

    @staticmethod
    def straight(
        is_open: UInt8[np.ndarray, "rows columns"],
        is_free: Bool[np.ndarray, "rows columns"],
        here: tuple[int, int],
    ) -> "Escape | None":
        """Take the free cell that is nearest in a straight line, whatever lies between (paper).

        Args:
            is_open: Mask of the cells where the robot may be: 1, and 0 elsewhere.
            is_free: Mask of the cells that are known to be free.
            here: Cell of the robot, ``(row, column)``.

        Returns:
            The escape, without cells if the robot stands in the open; None if the map has no open
            cell that is free, or if the robot is off the map.
        """
        row, column = here
        if not has_cell(is_open.shape, row, column):
            return None
        if is_open[row, column]:
            return Escape((row, column), np.zeros(is_open.shape, dtype=bool))
        exits = is_open * is_free
        to_row, to_column = nearest_open_cell(exits, row, column, max(is_open.shape))
        if to_row < 0:
            return None
        reach = math.dist(here, (to_row, to_column)) + _WIDTH_CELLS
        rows, columns = np.ogrid[: is_open.shape[0], : is_open.shape[1]]
        cells = (rows - row) ** 2 + (columns - column) ** 2 <= reach**2
        return Escape((int(to_row), int(to_column)), cells)
