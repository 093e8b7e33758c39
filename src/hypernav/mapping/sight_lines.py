"""Lines of sight on the map."""

import math

import numpy as np
from jaxtyping import Bool, Float64

from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.mapping.view_kernels import clear_lines


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
        starts: Start of every line, ``(x, y)``, metres.
        ends: End of every line, metres.
        through: Positions whose cells hide nothing, such as those of the object that is looked at.
    """
    own = np.zeros(grid.cells.shape, dtype=bool)
    cells = grid.cells_of(through)
    cells = cells[grid.contains(cells)]
    own[cells[:, 0], cells[:, 1]] = True
    lengths = np.linalg.norm(ends - starts, axis=1)
    samples = math.ceil(1.5 * float(lengths.max(initial=0.0)) / grid.resolution_m) + 1
    return clear_lines(
        grid.cells,
        own,
        np.array(grid.origin),
        grid.resolution_m,
        starts,
        ends - starts,
        np.linspace(0.0, 1.0, samples),
    )
