"""Maps drawn as text: ``.`` is free, ``#`` occupied, anything else unknown; first line on top."""

import numpy as np

from hypernav.core.exploring.overview import Block
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.mapping.blocks import blocks_of
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.reachable_area import ReachableArea

_STATES = {".": Cell.FREE, "#": Cell.OCCUPIED}


def drawn(text: str, *, scale: int = 1, origin: tuple[float, float] = (0.0, 0.0)) -> OccupancyGrid:
    """A grid of 5 cm cells; every letter is a square of `scale` cells."""
    lines = text.split()
    cells = np.array(
        [[_STATES.get(letter, Cell.UNKNOWN) for letter in line] for line in reversed(lines)],
        dtype=np.uint8,
    )
    return OccupancyGrid(np.kron(cells, np.ones((scale, scale), np.uint8)), 0.05, origin)


def divide_into_blocks(
    grid: OccupancyGrid, robot: Pose2, config: MappingConfig, clearance_m: float
) -> tuple[Block, ...]:
    """The blocks that a robot of this size can enter."""
    return blocks_of(ReachableArea.of(grid, robot, config, clearance_m), config)
