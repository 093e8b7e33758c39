"""Outlines of the standable cells of a grid, straightened."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64

from hypernav.core.geometry.transforms import distances_to_segment

_TOWARDS = ((0, 1), (1, 0), (0, -1), (-1, 0))
"""Steps in rows and columns along the sides of a cell, counter-clockwise: each turns left."""


@dataclass(frozen=True, eq=False)
class Outline:
    """A closed line around standable cells, or around a hole in them.

    Attributes:
        points: Corners in cells (x, y), with the standable cells on the left.
        cells: Standable cell ``[row, column]`` at every corner.
    """

    points: Float64[np.ndarray, "n 2"]
    cells: Int64[np.ndarray, "n 2"]


def outlines(standable: Bool[np.ndarray, "rows columns"], tolerance: float) -> list[Outline]:
    """The outlines of all standable cells.

    They run through the middles of the cells' sides, so that the staircase of a slanting line is
    nearly straight. Cells that only touch at a corner have separate outlines.

    Args:
        standable: The cells.
        tolerance: Largest distance between the outline and an omitted corner, cells.
    """
    return [_straightened(line, tolerance) for line in _traced(np.pad(standable, 1))]


def _traced(free: Bool[np.ndarray, "rows columns"]) -> list[Outline]:
    """Exact outlines; the grid has a border of one blocked cell, which isn't counted."""
    # A side is the cell and its direction of travel, with the cell on the left.
    sides: dict[tuple[int, int, int], None] = {}
    beyond = {0: (-1, 0), 1: (0, 1), 2: (1, 0), 3: (0, -1)}
    for direction, (down, right) in beyond.items():
        blocked = free & ~np.roll(free, (-down, -right), axis=(0, 1))
        for row, column in np.argwhere(blocked).tolist():
            sides[(row, column, direction)] = None
    lines = []
    while sides:
        side = next(iter(sides))
        points, cells = [], []
        while side in sides:
            del sides[side]
            row, column, direction = side
            down, right = beyond[direction]
            points.append((column - 0.5 + 0.5 * right, row - 0.5 + 0.5 * down))
            cells.append((row - 1, column - 1))
            side = _next(free, row, column, direction)
        lines.append(Outline(np.array(points), np.array(cells)))
    return lines


def _next(
    free: Bool[np.ndarray, "rows columns"], row: int, column: int, direction: int
) -> tuple[int, int, int]:
    """The next side: of this cell, of the one ahead, or of the one diagonally ahead."""
    ahead = row + _TOWARDS[direction][0], column + _TOWARDS[direction][1]
    if not free[ahead]:
        return row, column, (direction + 1) % 4
    right = _TOWARDS[(direction - 1) % 4]
    across = ahead[0] + right[0], ahead[1] + right[1]
    if free[across]:
        return (*across, (direction - 1) % 4)
    return (*ahead, direction)


def _straightened(line: Outline, tolerance: float) -> Outline:
    """Simplify by Douglas and Peucker's algorithm, between two corners that are far apart."""
    points = line.points
    far = int(np.argmax(((points - points[0]) ** 2).sum(axis=1)))
    kept = {0, far}
    waiting = [(0, far), (far, len(points))]
    closed = np.concatenate([points, points[:1]])
    while waiting:
        first, last = waiting.pop()
        if last - first < 2:
            continue
        gaps = distances_to_segment(closed[first + 1 : last], closed[first], closed[last])
        worst = int(np.argmax(gaps))
        if gaps[worst] > tolerance:
            middle = first + 1 + worst
            kept.add(middle)
            waiting += [(first, middle), (middle, last)]
    order = sorted(kept)
    if len(order) < 3:  # A thin outline must keep an area.
        order = list(range(len(points)))
    return Outline(points[order], line.cells[order])
