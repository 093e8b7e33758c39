"""Base layer of every map image: unknown, free and occupied cells as colours."""

import math
from functools import lru_cache, reduce
from typing import NamedTuple

import cv2
import numpy as np
from jaxtyping import Int64, UInt8

from hypernav.core.geometry.grid import Cell, OccupancyGrid, is_within
from hypernav.show.drawing.map_view import MapView
from hypernav.show.drawing.palette import FREE, OCCUPIED, UNKNOWN, Rgb, blend

# Cells are drawn in one grey channel and coloured at the end. An edge between free and occupied
# then passes through the grey of unknown for a fraction of a pixel, which is not visible.
_SHADE_OCCUPIED, _SHADE_UNKNOWN, _SHADE_FREE = 0, 128, 255
_SUPERSAMPLING = 2


class CellColors(NamedTuple):
    """Colours of the three states of a cell."""

    unknown: Rgb = UNKNOWN
    free: Rgb = FREE
    occupied: Rgb = OCCUPIED


@lru_cache(maxsize=4)
def _color_table(colors: CellColors) -> UInt8[np.ndarray, "1 256 3"]:
    def color(shade: int) -> Rgb:
        if shade <= _SHADE_UNKNOWN:
            return blend(colors.occupied, colors.unknown, shade / _SHADE_UNKNOWN)
        share = (shade - _SHADE_UNKNOWN) / (_SHADE_FREE - _SHADE_UNKNOWN)
        return blend(colors.unknown, colors.free, share)

    return np.array([[color(shade) for shade in range(256)]], dtype=np.uint8)


def _shade_table() -> UInt8[np.ndarray, "256"]:
    shades = np.full(256, _SHADE_UNKNOWN, dtype=np.uint8)
    shades[Cell.FREE] = _SHADE_FREE
    shades[Cell.OCCUPIED] = _SHADE_OCCUPIED
    return shades


_SHADES = _shade_table()


def rasterize_map(
    grid: OccupancyGrid, view: MapView, colors: CellColors | None = None
) -> UInt8[np.ndarray, "_ _ 3"]:
    """Draw the cells that a window shows, edges anti-aliased.

    If a pixel covers several cells and one is an obstacle, the obstacle is shown: thin walls stay
    visible on the map of a large building.

    Returns:
        RGB, ``view.size`` squared.
    """
    pixel_m = view.side_m / view.size
    factor = max(math.ceil(pixel_m / grid.resolution_m), 1)
    # Averaging would bleach a wall that is thinner than a pixel.
    samples = view.size * (_SUPERSAMPLING if factor == 1 else 1)
    cells, side_m = _downsampled(grid, factor)
    middles = (np.arange(samples) + 0.5) / samples * view.side_m
    columns = np.floor((view.left_m + middles - grid.origin[0]) / side_m).astype(np.int64)
    rows = np.floor((view.top_m - middles - grid.origin[1]) / side_m).astype(np.int64)
    shade = cv2.LUT(_cells_at(cells, rows, columns), _SHADES)
    if samples != view.size:
        shade = cv2.resize(shade, (view.size, view.size), interpolation=cv2.INTER_AREA)
    return cv2.LUT(cv2.cvtColor(shade, cv2.COLOR_GRAY2RGB), _color_table(colors or CellColors()))


def _downsampled(grid: OccupancyGrid, factor: int) -> tuple[UInt8[np.ndarray, "_ _"], float]:
    """The cells, each square of ``factor`` × ``factor`` reduced to one, and their side."""
    if factor == 1:
        return grid.cells, grid.resolution_m
    rows, columns = (-(-side // factor) for side in grid.cells.shape)
    padded = np.zeros((rows * factor, columns * factor), dtype=np.uint8)
    padded[: grid.cells.shape[0], : grid.cells.shape[1]] = grid.cells
    # The largest value of a square wins: occupied over free over unknown.
    for _ in range(2):
        # Comparing whole slices is many times faster than a maximum along an axis.
        slices = [padded[k::factor] for k in range(factor)]
        padded = reduce(np.maximum, slices).T
    return padded, grid.resolution_m * factor


def _cells_at(
    cells: UInt8[np.ndarray, "_ _"], rows: Int64[np.ndarray, "_"], columns: Int64[np.ndarray, "_"]
) -> UInt8[np.ndarray, "_ _"]:
    """The cell at every pair of row and column, unknown outside."""
    image = np.full((rows.size, columns.size), Cell.UNKNOWN, dtype=np.uint8)
    r = np.flatnonzero(is_within(rows, cells.shape[0]))
    c = np.flatnonzero(is_within(columns, cells.shape[1]))
    if r.size and c.size:
        # Rows decrease and columns increase, so the inside is one rectangle of the image.
        # Columns first: repeating whole rows is then a plain copy.
        part = np.take(np.take(cells, columns[c], axis=1), rows[r], axis=0)
        image[r[0] : r[-1] + 1, c[0] : c[-1] + 1] = part
    return image
