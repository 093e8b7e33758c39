"""Division of the explored map into numbered squares."""

import cv2
import numpy as np
from jaxtyping import Bool, Int64, UInt8

from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.overview import Block
from hypernav.mapping.config import MappingConfig
from hypernav.mapping.distance_kernels import nearest_open_cell
from hypernav.mapping.reachable_area import ReachableArea


def divide_into_blocks(
    grid: OccupancyGrid, robot: Pose2, config: MappingConfig, clearance_m: float
) -> tuple[Block, ...]:
    """Divide the explored map into squares and number those that the robot can enter.

    Args:
        grid: The map.
        robot: Pose of the robot.
        config: Size of the squares, and the free floor that a block needs.
        clearance_m: Distance from obstacles that the robot's middle keeps, metres.
    """
    return blocks_of(ReachableArea.of(grid, robot, config, clearance_m), config)


def blocks_of(reach: ReachableArea, config: MappingConfig) -> tuple[Block, ...]:
    """The numbered squares of a reachable area.

    The squares are aligned to the ``map`` frame and stay where they are as the map grows. Numbers
    run as one reads the drawn map: from the top left to the bottom right.

    Args:
        reach: The map and what the robot can reach on it.
        config: Size of the squares, and the free floor that a block needs.
    """
    side = config.block_size_m
    row_square, column_square = _squares(reach.grid, side)
    rows, columns = _runs(row_square), _runs(column_square)
    cells = np.add.reduceat(reach.reachable, rows, axis=0, dtype=np.int64)
    cells = np.add.reduceat(cells, columns, axis=1)
    is_block = cells * reach.grid.resolution_m**2 >= config.block_min_area_m2
    blocks: list[Block] = []
    for row, column in np.argwhere(is_block[::-1]):
        square_y = int(row_square[rows[len(rows) - 1 - row]])
        square_x = int(column_square[columns[column]])
        window = (_slice(row_square, square_y), _slice(column_square, square_x))
        blocks.append(
            _block(reach, window, len(blocks) + 1, square_x * side, square_y * side, config)
        )
    return tuple(blocks)


def _runs(squares: Int64[np.ndarray, "n"]) -> Int64[np.ndarray, "squares"]:
    """Where each square begins."""
    return np.flatnonzero(np.diff(squares, prepend=squares[0] - 1))


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
) -> Block:
    """The block of a window of the map."""
    reachable = np.ascontiguousarray(reach.reachable[window])
    size = reach.grid.resolution_m
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
        free_cells=int(np.count_nonzero(reach.grid.cells[window] == Cell.FREE)),
        frontier_cells=frontier_cells,
        destination=reach.grid.centre_of(row, column),
        travel_m=float(reach.travel_m[row, column]),
    )


def _largest_part(cells: UInt8[np.ndarray, "rows columns"]) -> Bool[np.ndarray, "rows columns"]:
    """The largest connected part of some cells, 8-connected."""
    _, parts, stats, _ = cv2.connectedComponentsWithStats(cells, connectivity=8)
    return parts == 1 + int(stats[1:, cv2.CC_STAT_AREA].argmax())
