"""Lines of sight on the map: whether they are clear, and the unknown floor that they would show."""

import math
from collections.abc import Sequence

import cv2
import numpy as np
from jaxtyping import Bool, Float64, Int64

from hypernav.core.exploring.overview import Block, Prospects
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.search.mapping.grid_kernels import clear_lines, travel_cells, unknown_in_view
from hypernav.search.mapping.reachable_area import ReachableArea

OPEN_M = 3.0
"""Length of unknown floor, metres, after which 1 / e of all lines of sight still go on; ours."""

_PATCH_CELLS = 4
"""Side of the patches in which the unknown is counted and paths are measured, cells."""
_RAYS = 180
"""Rays of a full turn: at 5 m they are no farther apart than a patch, with cells of 0.05 m."""


def unseen_by_bearing(
    grid: OccupancyGrid,
    position: tuple[float, float],
    bearings: Float64[np.ndarray, " n"],
    *,
    nearest_m: float,
    farthest_m: float,
) -> Float64[np.ndarray, " n"]:
    """Unknown floor around a position along lines of sight, which end at obstacles.

    The farther a line has gone through the unknown, the likelier something there has ended it, and
    the less the floor there counts.

    Args:
        grid: The map; beyond it all is unknown.
        position: Position ``(x, y)`` of the camera, ``map`` frame, metres.
        bearings: Directions in the ``map`` frame, radians, spread evenly around the circle.
        nearest_m: Distance of the nearest floor in the camera's image, metres.
        farthest_m: Range of the camera, metres.

    Returns:
        Expected area of unknown floor in sight in the sector of each direction, square metres.
    """
    spacing_m = grid.resolution_m
    along = np.arange(spacing_m / 2.0, farthest_m, spacing_m)
    away = along[:, None] * np.stack([np.cos(bearings), np.sin(bearings)])[:, None]
    points = np.array(position)[:, None, None] + away
    cells = grid.cells_of(points.reshape(2, -1).T)
    inside = grid.contains(cells)
    states = np.full(len(cells), Cell.UNKNOWN, dtype=np.uint8)
    states[inside] = grid.cells[cells[inside, 0], cells[inside, 1]]
    states = states.reshape(len(along), len(bearings))
    in_sight = np.cumsum(states == Cell.OCCUPIED, axis=0) == 0
    unknown = in_sight & (states == Cell.UNKNOWN)
    chance = np.exp(-np.cumsum(unknown, axis=0) * (spacing_m / OPEN_M))
    areas = np.where(along >= nearest_m, along, 0.0) * spacing_m * (2.0 * math.pi / len(bearings))
    return (unknown * chance * areas[:, None]).sum(axis=0)


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
        starts: Start of every line, ``(x, y)``, ``map`` frame, metres.
        ends: End of every line, ``(x, y)``, metres.
        through: Positions ``(x, y)``, metres, whose cells hide nothing: those of the object.
    """
    lengths = np.linalg.norm(ends - starts, axis=1)
    samples = math.ceil(1.5 * float(lengths.max(initial=0.0)) / grid.resolution_m) + 1
    return clear_lines(
        grid.cells,
        grid.mask_of(through),
        np.array(grid.origin),
        grid.resolution_m,
        starts,
        ends - starts,
        np.linspace(0.0, 1.0, samples),
    )


def block_prospects(reach: ReachableArea, range_m: float, blocks: Sequence[Block]) -> Prospects:
    """What visits to blocks would show: the unknown in view, and what is expected beyond stairs.

    Args:
        reach: The map and what the robot can reach on it.
        range_m: Range of the camera, metres.
        blocks: Blocks of this map.
    """
    shown = find_prospects(reach, [one.destination for one in blocks], range_m)
    leads_on = [k for k, one in enumerate(blocks) if one.beyond_m2 > 0.0]
    if not leads_on:
        return shown
    beyond = np.zeros((len(blocks), len(leads_on)), dtype=bool)
    beyond[leads_on, np.arange(len(leads_on))] = True
    return Prospects(
        np.concatenate([shown.areas_m2, [blocks[k].beyond_m2 for k in leads_on]]),
        np.concatenate([shown.shows, beyond], axis=1),
        np.concatenate([shown.positions, [blocks[k].destination for k in leads_on]]),
    )


def find_prospects(
    reach: ReachableArea, positions: Sequence[tuple[float, float]], range_m: float
) -> Prospects:
    """The unknown floor that a camera turned all around would see from some positions.

    A view's gain is the area that it shows, not the length of a boundary, after González-Baños and
    Latombe, "Navigation Strategies for Exploring Indoor Environments", 2002.

    Args:
        reach: The map and what the robot can reach on it.
        positions: Reachable positions ``(x, y)``, metres.
        range_m: Range of the camera, metres.
    """
    size = reach.grid.resolution_m
    at = _cells(reach, positions)
    range_cells = math.ceil(range_m / size)
    shows, chance = unknown_in_view(
        np.pad(reach.grid.cells, range_cells),  # the unknown goes on beyond the map
        at + range_cells,
        range_cells,
        _RAYS,
        OPEN_M / size,
        _PATCH_CELLS,
    )
    in_view = chance > 0.0
    patch_m = _PATCH_CELLS * size
    corner = np.array(reach.grid.origin) - range_cells * size
    middles = corner + (np.argwhere(in_view)[:, ::-1] + 0.5) * patch_m
    return Prospects(chance[in_view] * patch_m**2, shows[:, in_view], middles)


def find_legs_m(
    reach: ReachableArea, positions: Sequence[tuple[float, float]]
) -> Float64[np.ndarray, "n n"]:
    """Lengths of the paths between some positions, over patches that hold a reachable cell, metres.

    Args:
        reach: The map and what the robot can reach on it.
        positions: Reachable positions ``(x, y)``, metres.
    """
    side = _PATCH_CELLS
    at = _cells(reach, positions) // side
    # The largest value of each patch, at its first cell.
    dilated = cv2.dilate(reach.reachable, np.ones((side, side), np.uint8), anchor=(0, 0))
    patches = np.ascontiguousarray(dilated[::side, ::side])  # else one more compilation
    legs = np.zeros((len(at), len(at)))
    for k, (row, column) in enumerate(at[:-1]):
        others = at[k + 1 :]
        cells = travel_cells(patches, row, column, others)
        legs[k, k + 1 :] = legs[k + 1 :, k] = cells[others[:, 0], others[:, 1]]
    return legs * (side * reach.grid.resolution_m)


def _cells(
    reach: ReachableArea, positions: Sequence[tuple[float, float]]
) -> Int64[np.ndarray, "n 2"]:
    return reach.grid.cells_of(np.array(positions).reshape(-1, 2))
