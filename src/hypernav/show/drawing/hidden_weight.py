"""Weighs what a number written onto the image of a map would hide."""

import cv2

from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.show.drawing.map_raster import CellColors, rasterize_map
from hypernav.show.drawing.map_view import MapView


class HiddenWeight:
    """Weight of what a number would hide: obstacles count most, unknown little, floor nothing."""

    def __init__(self, grid: OccupancyGrid, view: MapView) -> None:
        """Weigh every pixel of an image of the map.

        Args:
            grid: The map.
            view: Part of the map that the image shows.
        """
        cells = CellColors((1, 0, 0), (0, 0, 0), (100, 0, 0))
        weights = rasterize_map(grid, view, cells)[..., 0]
        self._sums = cv2.integral(weights)
        self._most = view.size

    def weight(self, u: float, v: float, width: float, height: float) -> float:
        """Mean weight of the pixels under a number that is centred at ``(u, v)``."""
        left, right = (self._bounded(u + side * width / 2.0) for side in (-1, 1))
        top, bottom = (self._bounded(v + side * height / 2.0) for side in (-1, 1))
        sums = self._sums
        total = sums[bottom, right] - sums[top, right] - sums[bottom, left] + sums[top, left]
        return float(total) / max((right - left) * (bottom - top), 1)

    def _bounded(self, pixel: float) -> int:
        return min(max(round(pixel), 0), self._most)
