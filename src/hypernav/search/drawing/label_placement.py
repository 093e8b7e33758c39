"""Positions of names and of block numbers, so that all are readable and hide little."""

import math
from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import cv2

from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.search.drawing.map_view import CellColors, MapView, rasterize_map

_ROWS = (0.0, -1.0, 1.0, -2.0, 2.0)
_SAME_NAME_ROWS = 6.0

_OFFSETS = tuple(
    sorted(
        ((u / 4.0, v / 4.0) for u in range(-4, 5) for v in range(-4, 5)),
        key=lambda offset: (math.hypot(*offset), offset),
    )
)


class Label(NamedTuple):
    """A name and the position of its middle in an image, pixels.

    Attributes:
        text: The name.
        u: Column.
        v: Row.
        width: Width of the written name.
    """

    text: str
    u: float
    v: float
    width: float


def placed_labels(labels: Sequence[Label], height: float) -> list[Label]:
    """Labels where none covers another, moved by at most two rows.

    Earlier labels have priority. A label without room is left out, and so is one near another label
    of the same name: three kitchen cabinets in a row need only one.

    Args:
        labels: Labels where the things are.
        height: Height of a row, pixels.
    """
    placed: list[Label] = []
    for label in labels:
        if any(_says_the_same(label, other, height) for other in placed):
            continue
        placed += free_labels(moved_by_rows(label, height), placed, height)[:1]
    return placed


def moved_by_rows(label: Label, height: float) -> list[Label]:
    """A label where it is, and moved by one or two rows."""
    return [label._replace(v=label.v + row * height) for row in _ROWS]


def free_labels(labels: Iterable[Label], placed: Sequence[Label], height: float) -> list[Label]:
    """The labels that cover none of those placed."""
    return [one for one in labels if not _covers_any(one, placed, height)]


def _says_the_same(label: Label, other: Label, height: float) -> bool:
    near = math.hypot(label.u - other.u, label.v - other.v) < _SAME_NAME_ROWS * height
    return label.text == other.text and near


def _covers_any(label: Label, others: Sequence[Label], height: float) -> bool:
    return any(
        abs(label.u - other.u) < (label.width + other.width) / 2.0
        and abs(label.v - other.v) < height
        for other in others
    )


class Square(NamedTuple):
    """A block in an image, pixels.

    Attributes:
        left: Column of the left edge.
        top: Row of the upper edge.
        side: Side length.
    """

    left: float
    top: float
    side: float


class Disc(NamedTuple):
    """A region that must stay free, pixels."""

    u: float
    v: float
    radius: float


def number_position(
    square: Square, width: float, height: float, robot: Disc | None, mark: Disc | None = None
) -> tuple[float, float]:
    """Centre of a number, as near to the centre of its square as robot and mark allow.

    If the square is too small, the number may touch the mark rather than the robot; if it cannot
    hold number and robot, the number is moved out of it, directly away from the robot.

    Args:
        square: The block.
        width: Width of the written number.
        height: Height of the written number.
        robot: Disc that holds the robot's arrow.
        mark: Disc that holds the mark of the destination.

    Returns:
        ``(u, v)``.
    """
    positions = _positions(square, width, height)
    for obstacles in ((robot, mark), (robot,)):
        discs = [disc for disc in obstacles if disc is not None]
        for at in positions:
            if all(_apart(at, width, height, disc) for disc in discs):
                return at
    middle = positions[0]
    return _moved_away(middle, width, height, robot) if robot is not None else middle


def clear_position(
    square: Square,
    width: float,
    height: float,
    robot: Disc | None,
    cover: Callable[[float, float], float],
) -> tuple[float, float]:
    """Centre of a number that hides as little as possible, near the square's centre.

    Args:
        square: The block.
        width: Width of the written number.
        height: Height of the written number.
        robot: Disc that holds the robot's arrow.
        cover: Function that weighs what a number centred at ``(u, v)`` would hide.

    Returns:
        ``(u, v)``.
    """
    positions = _positions(square, width, height)
    if robot is not None:
        apart = [at for at in positions if _apart(at, width, height, robot)]
        positions = apart or [_moved_away(positions[0], width, height, robot)]
    return min(positions, key=lambda at: round(cover(*at), 3))


def _positions(square: Square, width: float, height: float) -> list[tuple[float, float]]:
    """Possible centres of a number within its square, from its middle outwards."""
    middle = (square.left + square.side / 2.0, square.top + square.side / 2.0)
    reach_u = max(square.side - width, 0.0) / 2.0
    reach_v = max(square.side - height, 0.0) / 2.0
    return [(middle[0] + u * reach_u, middle[1] + v * reach_v) for u, v in _OFFSETS]


def _apart(at: tuple[float, float], width: float, height: float, disc: Disc) -> bool:
    beyond_u = max(abs(at[0] - disc.u) - width / 2.0, 0.0)
    beyond_v = max(abs(at[1] - disc.v) - height / 2.0, 0.0)
    return math.hypot(beyond_u, beyond_v) >= disc.radius


def _moved_away(
    at: tuple[float, float], width: float, height: float, disc: Disc
) -> tuple[float, float]:
    away_u, away_v = at[0] - disc.u, at[1] - disc.v
    length = math.hypot(away_u, away_v)
    direction = (away_u / length, away_v / length) if length > 0.0 else (0.0, -1.0)
    distance = disc.radius + math.hypot(width, height) / 2.0
    return disc.u + direction[0] * distance, disc.v + direction[1] * distance


def number_size(squares: Sequence[Square], image_size: int, *, most: float = 1.0 / 30.0) -> int:
    """Font size of all numbers of an image, fitted to the smallest square, pixels.

    Args:
        squares: All blocks.
        image_size: Side of the image.
        most: Largest size, as a share of the image's side.
    """
    side = min((square.side for square in squares), default=0.0)
    return round(min(max(0.38 * side, image_size / 64.0, 9.0), image_size * most))


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
