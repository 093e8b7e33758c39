"""Division of the explored map into numbered squares."""

import cv2
import numpy as np
from jaxtyping import Bool, Int64, UInt8

from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.overview import Block
from hypernav.mapping.config import MappingConfig
from hypernav.mapping.distance_kernels import nearest_open_cell
from hypernav.mapping.reachable_area import ReachableArea


def divide_into_blocks(
    grid: OccupancyGrid, robot: Pose2, config: MappingConfig, clearance_m: float
) -> tuple[Block, ...]:
    """Divide the explored map into squares and number those that the robot can enter.

    The squares are aligned to the ``map`` frame and stay where they are as the map grows. Numbers
    run as one reads the drawn map: from the top left to the bottom right.

    Args:
        grid: The map.
        robot: Pose of the robot.
        config: Size of the squares, and the free floor that a block needs.
        clearance_m: Distance from obstacles that the robot's middle keeps, metres.
    """
    reach = ReachableArea.of(grid, robot, config, clearance_m)
    side = config.block_size_m
    row_square, column_square = _squares(reach.grid, side)
    blocks: list[Block] = []
    for square_y in range(row_square[-1], row_square[0] - 1, -1):
        for square_x in range(column_square[0], column_square[-1] + 1):
            window = (_slice(row_square, square_y), _slice(column_square, square_x))
            block = _block(reach, window, len(blocks) + 1, square_x * side, square_y * side, config)
            if block is not None:
                blocks.append(block)
    return tuple(blocks)


def _squares(
    grid: OccupancyGrid, side: float
) -> tuple[Int64[np.ndarray, "rows"], Int64[np.ndarray, "columns"]]:
    """Number of the square that holds the middle of every row, and of every column, of cells."""
    rows, columns = grid.cells.shape
    y = grid.origin[1] + (np.arange(rows) + 0.5) * grid.resolution_m
    x = grid.origin[0] + (np.arange(columns) + 0.5) * grid.resolution_m
    return np.floor(y / side).astype(np.int64), np.floor(x / side).astype(np.int64)


def _slice(squares: Int64[np.ndarray, "n"], square: int) -> slice:
    first, last = np.searchsorted(squares, [square, square + 1])
    return slice(int(first), int(last))


def _block(
    reach: ReachableArea,
    window: tuple[slice, slice],
    number: int,
    x_min: float,
    y_min: float,
    config: MappingConfig,
) -> Block | None:
    """The block of a window of the map; None if the robot finds too little floor there."""
    reachable = np.ascontiguousarray(reach.reachable[window])
    size = reach.grid.resolution_m
    if np.count_nonzero(reachable) * size**2 < config.block_min_area_m2:
        return None
    bottom, left = window[0].start, window[1].start
    frontier = np.ascontiguousarray(reach.frontier[window]).view(np.uint8)
    far = max(frontier.shape)
    frontier_cells = int(np.count_nonzero(frontier))
    if frontier_cells and config.block_destination == "frontier":
        rows, columns = np.nonzero(_largest_part(frontier))
        middle = (round(float(rows.mean())), round(float(columns.mean())))
        row, column = nearest_open_cell(frontier, *middle, far)
        row, column = reach.look_out(row + bottom, column + left)
    else:
        # The middle of a square may be the edge of two cells; half a cell more is in one of them.
        half = (config.block_size_m + size) / 2.0
        middle = reach.grid.cell_of(x_min + half, y_min + half)
        row, column = nearest_open_cell(reachable, middle[0] - bottom, middle[1] - left, far)
        row, column = row + bottom, column + left
    return Block(
        number=number,
        x_min=x_min,
        y_min=y_min,
        size_m=config.block_size_m,
        free_cells=int(np.count_nonzero(reach.grid.free[window])),
        frontier_cells=frontier_cells,
        destination=reach.grid.centre_of(row, column),
        travel_m=float(reach.travel_m[row, column]),
    )


def _largest_part(cells: UInt8[np.ndarray, "rows columns"]) -> Bool[np.ndarray, "rows columns"]:
    """The largest connected part of some cells, 8-connected."""
    _, parts, stats, _ = cv2.connectedComponentsWithStats(cells, connectivity=8)
    return parts == 1 + int(stats[1:, cv2.CC_STAT_AREA].argmax())
