"""The way out for a robot that stands too close to an obstacle."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, UInt8

from hypernav.core.geometry.bounds import has_cell
from hypernav.mapping.distance_kernels import travel_cells

_WITHIN_M = 1.0
"""How far away an open cell may be."""
_WIDTH_CELLS = 1.5
"""How much longer than the shortest the way out may be: it is driven in long steps."""


@dataclass(frozen=True, eq=False)
class Escape:
    """How to get to open floor from a cell where the robot should not be.

    Attributes:
        exit: The open cell ``(row, column)`` that is nearest by way, not through the air: the one
            behind a thin wall is none.
        cells: The cells between, and those around the robot that are no farther away.
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
        """Look for it between the obstacles or, if they leave none, across them.

        Args:
            occupied: The obstacles themselves.
            is_open: 1 where the robot may be.
            here: ``(row, column)`` of the robot.
            cell_size_m: Side of a cell.

        Returns:
            The way out, empty if the robot stands in the open; None if nothing open is near, or if
            the robot is off the map.
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
            way = travel_cells(passable.view(np.uint8), row - bottom, column - left)
            way_to_open = np.where(is_open[window] > 0, way, np.inf)
            nearest = np.unravel_index(int(way_to_open.argmin()), way.shape)
            if np.isfinite(way_to_open[nearest]):
                cells[window] = way <= way[nearest] + _WIDTH_CELLS
                return Escape((int(nearest[0]) + bottom, int(nearest[1]) + left), cells)
        return None
