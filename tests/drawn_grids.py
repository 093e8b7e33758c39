"""Maps drawn as text: ``.`` is free, ``#`` occupied, anything else unknown; first line on top."""

import numpy as np

from hypernav.core.geometry.grid import Cell, OccupancyGrid

_STATES = {".": Cell.FREE, "#": Cell.OCCUPIED}


def drawn(text: str, *, scale: int = 1, origin: tuple[float, float] = (0.0, 0.0)) -> OccupancyGrid:
    """A grid of 5 cm cells; every letter is a square of `scale` cells."""
    lines = text.split()
    cells = np.array(
        [[_STATES.get(letter, Cell.UNKNOWN) for letter in line] for line in reversed(lines)],
        dtype=np.uint8,
    )
    return OccupancyGrid(np.kron(cells, np.ones((scale, scale), np.uint8)), 0.05, origin)
