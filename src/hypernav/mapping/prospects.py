"""The unknown floor that positions on the map would show, and the paths between them."""

import math
from collections.abc import Sequence

import cv2
import numpy as np
from jaxtyping import Float64, Int64

from hypernav.core.exploring.overview import Block, Prospects
from hypernav.mapping.distance_kernels import travel_cells
from hypernav.mapping.reachable_area import ReachableArea
from hypernav.mapping.sight_lines import OPEN_M
from hypernav.mapping.view_kernels import unknown_in_view

_PATCH_CELLS = 4
"""Side of the patches in which the unknown is counted and paths are measured, cells."""
_RAYS = 180
"""Rays of a full turn: at 5 m they are no farther apart than a patch, with cells of 0.05 m."""


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
