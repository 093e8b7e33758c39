"""Lines of sight on the map."""

import math

import numpy as np
from jaxtyping import Bool, Float64

from hypernav.core.geometry.grid import OccupancyGrid


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
    hides = grid.occupied
    own = grid.cells_of(through)
    own = own[grid.contains(own)]
    hides[own[:, 0], own[:, 1]] = False
    lengths = np.linalg.norm(ends - starts, axis=1)
    samples = math.ceil(1.5 * float(lengths.max(initial=0.0)) / grid.resolution_m) + 1
    share = np.linspace(0.0, 1.0, samples)[None, :, None]
    cells = grid.cells_of((starts[:, None] + share * (ends - starts)[:, None]).reshape(-1, 2))
    known = grid.contains(cells)
    hidden = np.zeros(len(cells), dtype=bool)
    hidden[known] = hides[cells[known, 0], cells[known, 1]]
    return np.logical_not(hidden.reshape(len(starts), samples).any(axis=1))
