"""Division of the explored map into blocks: numbered squares."""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

import cv2
import numpy as np
from jaxtyping import Bool, Int64, UInt8

from hypernav.core.exploring.floors import Drop, WayOut
from hypernav.core.exploring.overview import Block
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.grid_kernels import nearest_open_cell
from hypernav.search.mapping.reachable_area import ReachableArea

CLIMB_M = 8.0
"""Length of path that stairs to another floor are worth, metres: their own, and the path back."""
FLOOR_SHARE = 0.5
"""Worth of an unseen floor, by the area that was seen of this one: the more of it was seen without
the goal, the likelier that is on another."""
_DROP_SHARE = 0.5
"""Worth of where the floor ends, as it does at the head of stairs, and behind a railing, by that of
stairs."""
STAIRS_SIDE_M = 1.0


def blocks_of(reach: ReachableArea, config: MappingConfig, first: int = 1) -> tuple[Block, ...]:
    """The blocks of a reachable area.

    The squares are aligned to the ``map`` frame and stay where they are as the map grows. Numbers
    follow the order of reading the drawn map: from the top left to the bottom right.

    Args:
        reach: The map and what the robot can reach on it.
        config: Size of the squares, and the reachable floor that a block needs.
        first: Number of the first block.
    """
    row_squares, rows = _squares(reach.grid, config.block_size_m, axis=0)
    column_squares, columns = _squares(reach.grid, config.block_size_m, axis=1)
    floor_m2 = _counts(reach.reachable, rows, columns) * reach.grid.resolution_m**2
    free_cells = _counts(reach.grid.free, rows, columns)
    frontier_cells = _counts(reach.frontier, rows, columns)
    blocks: list[Block] = []
    for from_top, column in np.argwhere(floor_m2[::-1] >= config.block_min_area_m2):
        row = len(row_squares) - 1 - from_top
        x_min = int(column_squares[column]) * config.block_size_m
        y_min = int(row_squares[row]) * config.block_size_m
        window = (slice(*rows[row : row + 2]), slice(*columns[column : column + 2]))
        if frontier_cells[row, column] > 0 and config.block_destination == "frontier":
            destination = _at_frontier(reach, window)
        else:
            # The middle of a square may be the edge of two cells; half a cell more is in one.
            half = (config.block_size_m + reach.grid.resolution_m) / 2.0
            middle = reach.grid.cell_of(x_min + half, y_min + half)
            destination = _nearest(reach.reachable, window, middle)
        blocks.append(
            Block(
                number=first + len(blocks),
                x_min=x_min,
                y_min=y_min,
                size_m=config.block_size_m,
                free_cells=int(free_cells[row, column]),
                frontier_cells=int(frontier_cells[row, column]),
                destination=reach.grid.centre_of(*destination),
                travel_m=float(reach.travel_m[destination]),
            )
        )
    return tuple(blocks)


def stairs_blocks(
    reach: ReachableArea, ways_out: Sequence[WayOut], first: int
) -> tuple[Block, ...]:
    """Stairs to other floors as blocks of their own, those that can be reached.

    Args:
        reach: The map and what the robot can reach on it.
        ways_out: The stairs.
        first: Number of the first of them.
    """
    blocks: list[Block] = []
    beyond_m2 = FLOOR_SHARE * reach.grid.free_m2
    for one in ways_out:
        there = _block_at(reach, one.xy, first + len(blocks), STAIRS_SIDE_M / 2.0)
        if there is not None:
            to = {"connector": one.connector, "words": one.words, "beyond_m2": beyond_m2}
            blocks.append(replace(there, **to))
    return tuple(blocks)


def drop_blocks(reach: ReachableArea, drops: Sequence[Drop], first: int) -> tuple[Block, ...]:
    """Edges of the floor as blocks of their own, those that the robot can go to.

    Args:
        reach: The map and what the robot can reach on it.
        drops: Where the floor ends.
        first: Number of the first of them.
    """
    blocks: list[Block] = []
    beyond_m2 = _DROP_SHARE * FLOOR_SHARE * reach.grid.free_m2
    for one in drops:
        # there may be a railing before it
        there = _block_at(reach, one.xy, first + len(blocks), STAIRS_SIDE_M)
        if there is not None:
            x, y = there.destination
            face = math.atan2(one.y - y, one.x - x) if one.axis is None else one.axis
            blocks.append(replace(there, words="the floor ends", beyond_m2=beyond_m2, face=face))
    return tuple(blocks)


def _block_at(
    reach: ReachableArea, position: tuple[float, float], number: int, within_m: float
) -> Block | None:
    """A block around a position ``(x, y)``, metres; None if the robot can't go near it."""
    within_cells = int(within_m / reach.grid.resolution_m + 1e-9)
    at = nearest_open_cell(reach.reachable, *reach.grid.cell_of(*position), within_cells)
    if at == (-1, -1):
        return None
    return Block(
        number=number,
        x_min=position[0] - STAIRS_SIDE_M / 2.0,
        y_min=position[1] - STAIRS_SIDE_M / 2.0,
        size_m=STAIRS_SIDE_M,
        free_cells=0,
        frontier_cells=round(STAIRS_SIDE_M / reach.grid.resolution_m),
        destination=reach.grid.centre_of(*at),
        travel_m=float(reach.travel_m[at]),
    )


def _squares(
    grid: OccupancyGrid, side_m: float, axis: int
) -> tuple[Int64[np.ndarray, "squares"], list[int]]:
    """Numbers of the squares along an axis, and the cells at their edges, the last included."""
    cells = np.arange(grid.cells.shape[axis])
    middles = grid.origin[1 - axis] + (cells + 0.5) * grid.resolution_m
    squares, first = np.unique(np.floor(middles / side_m).astype(np.int64), return_index=True)
    return squares, [*first.tolist(), len(cells)]


def _counts(
    mask: Bool[np.ndarray, "rows columns"] | UInt8[np.ndarray, "rows columns"],
    rows: list[int],
    columns: list[int],
) -> Int64[np.ndarray, "_ _"]:
    """Number of a mask's cells in every square, ``[row, column]``."""
    sums = cv2.integral(mask.view(np.uint8))[np.ix_(rows, columns)].astype(np.int64)
    return np.diff(np.diff(sums, axis=0), axis=1)


def _at_frontier(reach: ReachableArea, window: tuple[slice, slice]) -> tuple[int, int]:
    """The reachable cell nearest to the middle of the largest frontier in a window."""
    frontier = np.ascontiguousarray(reach.frontier[window]).view(np.uint8)
    row, column = _middle_of_largest(frontier.tobytes(), frontier.shape[1])
    return reach.look_out(row + window[0].start, column + window[1].start)


@lru_cache(maxsize=1024)
def _middle_of_largest(frontier: bytes, columns: int) -> tuple[int, int]:
    """Row and column of the frontier cell in the middle; cached, since squares seldom change.

    Args:
        frontier: Cells of a square, row by row: 1 at a frontier, at least one, 0 elsewhere.
        columns: Width of the square.
    """
    # A copy, since arrays that can't be written to need compilations of their own.
    cells = np.frombuffer(frontier, dtype=np.uint8).reshape(-1, columns).copy()
    _, _, stats, middles = cv2.connectedComponentsWithStats(cells, connectivity=8)
    largest = 1 + int(stats[1:, cv2.CC_STAT_AREA].argmax())
    middle = (round(middles[largest, 1]), round(middles[largest, 0]))
    return nearest_open_cell(cells, *middle, max(cells.shape))


def _nearest(
    mask: UInt8[np.ndarray, "rows columns"], window: tuple[slice, slice], to: tuple[int, int]
) -> tuple[int, int]:
    """The cell of a mask in a window that is nearest to a cell."""
    bottom, left = window[0].start, window[1].start
    inner = np.ascontiguousarray(mask[window])
    row, column = nearest_open_cell(inner, to[0] - bottom, to[1] - left, max(inner.shape))
    return row + bottom, column + left
