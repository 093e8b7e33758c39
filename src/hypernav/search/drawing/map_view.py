"""Window of the map that an image shows, and its cells as colours.

Metres become pixels, and pixels metres; y is flipped only here.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache, reduce
from typing import NamedTuple

import cv2
import numpy as np
from jaxtyping import Float, Float64, Int64, UInt8

from hypernav.core.geometry.grid import Cell, OccupancyGrid, is_within
from hypernav.search.drawing.palette import FREE, OCCUPIED, UNKNOWN, Rgb, blend

_SMALLEST_M = 4.0
_EMPTY = (math.inf, math.inf, -math.inf, -math.inf)

Bounds = tuple[float, float, float, float]
"""``(x_min, y_min, x_max, y_max)``, metres, ``map`` frame."""

# Cells are drawn in one grey channel and coloured at the end. An edge between free and occupied
# then passes through the grey of unknown for a fraction of a pixel, which is not visible.
_SHADE_OCCUPIED, _SHADE_UNKNOWN, _SHADE_FREE = 0, 128, 255
_SUPERSAMPLING = 2


@dataclass(frozen=True)
class MapView:
    """A square window on the map.

    Pixel coordinates ``(u, v)`` count from the upper left corner of the image, v downwards;
    pixel column c covers ``[c, c + 1)``.

    Attributes:
        left_m: x of the left edge of the image, ``map`` frame, metres.
        top_m: y of the upper edge of the image, ``map`` frame, metres.
        pixels_per_m: Scale.
        size: Side of the image, pixels.
    """

    left_m: float
    top_m: float
    pixels_per_m: float
    size: int

    @property
    def side_m(self) -> float:
        """Side of the window, metres."""
        return self.size / self.pixels_per_m

    @staticmethod
    def around(bounds: Bounds, size: int, *, margin: float = 0.05) -> "MapView":
        """Fit and centre a rectangle.

        Args:
            bounds: Rectangle that must be visible; anything smaller than 4 m is shown with room
                around it.
            size: Side of the image, pixels.
            margin: Empty rim on every side, as a share of the image.
        """
        if bounds[0] > bounds[2]:
            bounds = (0.0, 0.0, 0.0, 0.0)
        extent = max(bounds[2] - bounds[0], bounds[3] - bounds[1], _SMALLEST_M)
        side = extent / (1.0 - 2.0 * margin)
        return MapView(
            left_m=(bounds[0] + bounds[2] - side) / 2.0,
            top_m=(bounds[1] + bounds[3] + side) / 2.0,
            pixels_per_m=size / side,
            size=size,
        )

    @staticmethod
    def fit(
        grid: OccupancyGrid,
        size: int,
        *,
        points: Iterable[tuple[float, float]] = (),
        margin: float = 0.05,
    ) -> "MapView":
        """Fit and centre the explored area.

        Args:
            grid: The map.
            size: Side of the image, pixels.
            points: Further points that must be visible, ``map`` frame, metres.
            margin: Empty rim on every side, as a share of the image.
        """
        return MapView.around(explored_bounds(grid, points), size, margin=margin)

    def to_pixels(self, points: Float[np.ndarray, "n 2"]) -> Float64[np.ndarray, "n 2"]:
        """``(u, v)`` of every ``(x, y)`` in metres."""
        corner = np.array([self.left_m, self.top_m])
        return (points - corner) * np.array([self.pixels_per_m, -self.pixels_per_m])

    def to_metres(self, pixels: Float[np.ndarray, "n 2"]) -> Float64[np.ndarray, "n 2"]:
        """``(x, y)`` of every ``(u, v)``."""
        corner = np.array([self.left_m, self.top_m])
        return pixels / np.array([self.pixels_per_m, -self.pixels_per_m]) + corner

    def pixel_of(self, x: float, y: float) -> tuple[float, float]:
        """``(u, v)`` of one point in metres."""
        return (x - self.left_m) * self.pixels_per_m, (self.top_m - y) * self.pixels_per_m

    def shows(self, bounds: Bounds) -> bool:
        """Whether a rectangle is completely visible."""
        return (
            self.left_m <= bounds[0]
            and bounds[2] <= self.left_m + self.side_m
            and self.top_m - self.side_m <= bounds[1]
            and bounds[3] <= self.top_m
        )


def explored_bounds(grid: OccupancyGrid, points: Iterable[tuple[float, float]] = ()) -> Bounds:
    """The rectangle around explored cells and points; inverted if there is nothing."""
    x_min, y_min, x_max, y_max = _EMPTY
    column, row, columns, rows = cv2.boundingRect(grid.cells)
    if columns and rows:
        r = grid.resolution_m
        x_min, y_min = grid.origin[0] + column * r, grid.origin[1] + row * r
        x_max, y_max = x_min + columns * r, y_min + rows * r
    for x, y in points:
        x_min, y_min, x_max, y_max = min(x_min, x), min(y_min, y), max(x_max, x), max(y_max, y)
    return x_min, y_min, x_max, y_max


class SteadyView:
    """Keeps a video's map still: moves the window only when the explored area outgrows it.

    Each new window has room to grow, so that the image rarely jumps.
    """

    def __init__(self, size: int, *, room: float = 1.12) -> None:
        """Begin without a window.

        Args:
            size: Side of the image, pixels.
            room: Size of a new window relative to the needed size.
        """
        self._size = size
        self._room = room
        self._view: MapView | None = None

    def follow(self, grid: OccupancyGrid, points: Iterable[tuple[float, float]] = ()) -> MapView:
        """The window for the next image."""
        bounds = explored_bounds(grid, points)
        rim = 0.04
        if self._view is None or not self._view.shows(_grown(bounds, rim * self._view.side_m)):
            margin = (1.0 - (1.0 - 2.0 * rim) / self._room) / 2.0
            self._view = MapView.around(bounds, self._size, margin=margin)
        return self._view


def _grown(bounds: Bounds, by: float) -> Bounds:
    if bounds[0] > bounds[2]:
        bounds = (0.0, 0.0, 0.0, 0.0)
    return bounds[0] - by, bounds[1] - by, bounds[2] + by, bounds[3] + by


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
