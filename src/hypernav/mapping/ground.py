"""The ground around a robot that climbs: what of it can be walked on, and how high it is."""

import math
from dataclasses import dataclass, replace
from functools import cached_property

import cv2
import numpy as np
from jaxtyping import Bool, Float32, Float64, UInt8

from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.mapping.distance import distance_from
from hypernav.mapping.distance_kernels import nearest_open_cell

_REACHED = 2
"""Value, other than 0 and 1, of the cells that a fill has come to."""
_NEAR_M = 0.4
"""Distance within which the ground under the robot is looked for, metres."""


@dataclass(frozen=True, eq=False)
class UnseenGround:
    """The unseen cells that count as ground, as right before the robot.

    Attributes:
        cells: Mask of them.
        around: Heights from which theirs are filled in, metres; NaN where none is known.
    """

    cells: Bool[np.ndarray, "rows columns"]
    around: Float32[np.ndarray, "rows columns"]

    @cached_property
    def heights(self) -> Float32[np.ndarray, "rows columns"]:
        """Heights of all cells as filled in, metres; worked out when they are asked for."""
        return filled(self.around)


@dataclass(frozen=True, eq=False)
class Ground:
    """The part of the ground that the robot could walk to over steps that it can climb.

    What only few steps need is worked out when it is asked for.

    Attributes:
        grid: The open ground, free where the robot could step on it and occupied elsewhere.
        measured: Height of the ground where it was seen, ``map`` frame, metres; where steps down
            are presumed, an upper bound; NaN elsewhere.
        seen: Mask of the cells whose ground was seen.
        reached: Mask of the cells where the robot's middle could get.
        presumed: Mask of the cells where stairs down are presumed, since no ground was seen at the
            robot's height, but what lies below it.
        least_m: Clearance that the robot's middle needs, metres.
        unseen: The unseen cells that count as ground.
        stood: Mask of the cells whose height is that of a robot that stood there, and that no image
            has shown since.
    """

    grid: OccupancyGrid
    measured: Float32[np.ndarray, "rows columns"]
    seen: Bool[np.ndarray, "rows columns"]
    reached: Bool[np.ndarray, "rows columns"]
    presumed: Bool[np.ndarray, "rows columns"]
    least_m: float
    unseen: UnseenGround
    stood: Bool[np.ndarray, "rows columns"]

    @cached_property
    def heights(self) -> Float32[np.ndarray, "rows columns"]:
        """Heights of the ground, metres: where it was not seen, filled in; else as measured."""
        return np.where(self.unseen.cells, self.unseen.heights, self.measured)

    @cached_property
    def clearance_m(self) -> Float32[np.ndarray, "rows columns"]:
        """Distance of every cell from what is not open ground, metres."""
        return distance_from(~self.grid.free) * np.float32(self.grid.resolution_m)

    def without(
        self, closed: Bool[np.ndarray, "rows columns"], position: tuple[float, float]
    ) -> "Ground":
        """The ground where some cells are closed, as far as it is in reach from a position."""
        cells = np.where(closed, np.uint8(Cell.OCCUPIED), self.grid.cells)
        grid = replace(self.grid, cells=cells)
        return replace(self, grid=grid, reached=reach(grid, position, self.least_m))

    def between(self, low_m: float, high_m: float) -> Bool[np.ndarray, "rows columns"]:
        """Mask of the reached cells whose heights lie between two, metres."""
        with np.errstate(invalid="ignore"):
            return self.reached & (self.heights >= low_m) & (self.heights <= high_m)

    def area_m2(self, mask: Bool[np.ndarray, "rows columns"]) -> float:
        """Area of a mask's cells, square metres."""
        return float(mask.sum()) * self.grid.resolution_m**2

    def nearest_reached(self, position: tuple[float, float]) -> tuple[int, int] | None:
        """The reached cell ``(row, column)`` nearest to a position; None if none is near it."""
        return nearest_cell(self.reached, self.grid, position)

    def distances_m(self, position: tuple[float, float]) -> Float64[np.ndarray, "rows columns"]:
        """Straight distances of all cells from a position, metres."""
        row, column = self.grid.cell_of(*position)
        rows, columns = np.ogrid[: self.heights.shape[0], : self.heights.shape[1]]
        return np.hypot(rows - row, columns - column) * self.grid.resolution_m

    def along(
        self, position: tuple[float, float], axis: float
    ) -> tuple[Float64[np.ndarray, "rows columns"], Float64[np.ndarray, "rows columns"]]:
        """How far ahead of a position along an axis (radians), and beside it, cells lie, metres."""
        row, column = self.grid.cell_of(*position)
        rows, columns = np.ogrid[: self.heights.shape[0], : self.heights.shape[1]]
        y, x = (rows - row) * self.grid.resolution_m, (columns - column) * self.grid.resolution_m
        cos, sin = math.cos(axis), math.sin(axis)
        return x * cos + y * sin, np.abs(y * cos - x * sin)

    def positions(self, mask: Bool[np.ndarray, "rows columns"]) -> Float64[np.ndarray, "n 2"]:
        """Middles ``(x, y)`` of a mask's cells, metres."""
        return self.grid.centres_of(np.argwhere(mask))


def reach(
    grid: OccupancyGrid, position: tuple[float, float], least_m: float
) -> Bool[np.ndarray, "rows columns"]:
    """Mask of the cells that keep clear of what is not free, in reach of a position.

    Args:
        grid: Free and other cells.
        position: The robot ``(x, y)``, metres.
        least_m: Clearance that its middle needs, metres.
    """
    is_open = (grid.cells == Cell.FREE).view(np.uint8)
    fits = cv2.erode(is_open, _disc(least_m / grid.resolution_m))
    start = nearest_cell(fits > 0, grid, position)
    if start is None:
        return np.zeros(fits.shape, dtype=np.bool_)
    cv2.floodFill(fits, None, start[::-1], _REACHED)
    return fits == _REACHED


def closed(mask: Bool[np.ndarray, "rows columns"], side: int) -> Bool[np.ndarray, "rows columns"]:
    """The mask with its gaps that a square of so many cells doesn't fit into."""
    square = np.ones((side, side), np.uint8)
    return cv2.morphologyEx(mask.view(np.uint8), cv2.MORPH_CLOSE, square) > 0


def _disc(radius: float) -> UInt8[np.ndarray, "rows columns"]:
    """Square of cells, 1 where the middle is at most so many cells away."""
    side = np.arange(-int(radius), int(radius) + 1)
    return (np.hypot(side[:, None], side[None, :]) <= radius).astype(np.uint8)


def nearest_cell(
    mask: Bool[np.ndarray, "rows columns"], grid: OccupancyGrid, position: tuple[float, float]
) -> tuple[int, int] | None:
    """The cell of a mask nearest to a position; None if none is within `_NEAR_M`."""
    within = math.ceil(_NEAR_M / grid.resolution_m)
    cell = nearest_open_cell(mask.view(np.uint8), *grid.cell_of(*position), within)
    return None if cell == (-1, -1) else cell


def filled(heights: Float32[np.ndarray, "rows columns"]) -> Float32[np.ndarray, "rows columns"]:
    """The heights with all gaps filled in: averages of what is known around, the nearest first.

    The pyramid of Gortler et al., "The Lumigraph", 1996 ("pull and push").
    """
    known = ~np.isnan(heights)
    weights = [known.astype(np.float32)]
    totals = [np.where(known, heights, np.float32(0.0))]
    while min(weights[-1].shape) > 1 and (weights[-1] == 0.0).any():
        half = (weights[-1].shape[1] // 2, weights[-1].shape[0] // 2)
        sums = [
            cv2.resize(one, half, interpolation=cv2.INTER_AREA) for one in (weights[-1], totals[-1])
        ]
        mean = sums[1] / np.maximum(sums[0], 1e-9)
        weights.append(np.minimum(sums[0] * 4.0, 1.0))
        totals.append(mean * weights[-1])
    level = totals[-1]
    for weight, total in zip(weights[-2::-1], totals[-2::-1], strict=True):
        wider = cv2.resize(level, total.shape[::-1], interpolation=cv2.INTER_LINEAR)
        level = total + (1.0 - weight) * wider
    return level
