"""The explored map in numbered squares."""

import numpy as np

from hypernav.core.geometry import Pose2
from hypernav.core.grid import OccupancyGrid
from hypernav.core.overview import Block
from hypernav.mapping.config import MappingConfig
from hypernav.mapping.frontiers import look_out
from hypernav.mapping.reach import Reach


def divide_into_blocks(
    grid: OccupancyGrid, robot: Pose2, config: MappingConfig
) -> tuple[Block, ...]:
    """Divide the explored map into squares and number those that the robot can enter.

    The squares are aligned to the ``map`` frame and stay where they are as the map grows. Numbers
    run as one reads the drawn map: from the top left to the bottom right.

    Args:
        grid: The map.
        robot: Where the robot is.
        config: Size of the squares, least free floor, clearance.
    """
    reach = Reach.of(grid, robot, config)
    side = config.block_size_m
    origin, size = reach.grid.origin, reach.grid.resolution_m
    rows, columns = reach.grid.cells.shape
    # Whole squares of the frame: cell edges are rounded to the square that holds their middle.
    row_square = np.floor((origin[1] + (np.arange(rows) + 0.5) * size) / side).astype(int)
    column_square = np.floor((origin[0] + (np.arange(columns) + 0.5) * size) / side).astype(int)
    blocks: list[Block] = []
    for square_y in range(row_square[-1], row_square[0] - 1, -1):
        for square_x in range(column_square[0], column_square[-1] + 1):
            window = (_slice(row_square, square_y), _slice(column_square, square_x))
            block = _block(reach, window, len(blocks) + 1, square_x * side, square_y * side, config)
            if block is not None:
                blocks.append(block)
    return tuple(blocks)


def _slice(squares: np.ndarray, square: int) -> slice:
    first, last = np.searchsorted(squares, [square, square + 1])
    return slice(int(first), int(last))


def _block(
    reach: Reach,
    window: tuple[slice, slice],
    number: int,
    x_min: float,
    y_min: float,
    config: MappingConfig,
) -> Block | None:
    can_stand = np.isfinite(reach.travel_m[window])
    if can_stand.sum() * reach.grid.resolution_m**2 < config.block_min_area_m2:
        return None
    top, left = window[0].start, window[1].start
    frontier = reach.frontier[window]
    if frontier.any():
        cells = np.argwhere(frontier)
        middle = reach.closest_to(*cells.mean(axis=0), frontier)
        row, column = look_out(reach, int(middle[0]) + top, int(middle[1]) + left)
    else:
        middle = np.array(can_stand.shape) / 2.0 - 0.5
        nearest = reach.closest_to(*middle, can_stand)
        row, column = int(nearest[0]) + top, int(nearest[1]) + left
    return Block(
        number=number,
        x_min=x_min,
        y_min=y_min,
        size_m=config.block_size_m,
        free_cells=int(reach.grid.free[window].sum()),
        frontier_cells=int(frontier.sum()),
        destination=reach.grid.centre_of(row, column),
        travel_m=float(reach.travel_m[row, column]),
    )
