"""Legend of a map: its colours and marks in one row."""

import math
from collections.abc import Callable, Sequence
from enum import StrEnum

import numpy as np
from jaxtyping import UInt8

from hypernav.search.drawing import palette, shapes
from hypernav.search.drawing.shapes import draw_robot
from hypernav.search.drawing.text import draw_text, text_width

_Drawing = Callable[[UInt8[np.ndarray, "_ _ 3"], float, float, float], None]
"""Draws a sample into a box: image, left, middle, side, all in pixels."""


class Layer(StrEnum):
    """Layers of a map, named as in the legend."""

    FREE = "free floor"
    OCCUPIED = "obstacle"
    UNKNOWN = "not seen yet"
    START = "start"
    TRAJECTORY = "path so far"
    ROBOT = "robot"
    PATH = "plan"
    DESTINATION = "destination"
    GOAL = "goal"
    CHOSEN = "chosen block"


def draw_legend(
    image: UInt8[np.ndarray, "_ _ 3"],
    layers: Sequence[Layer],
    *,
    left: float,
    middle: float,
    size: int = 14,
    gap: float = 1.3,
) -> float:
    """Draw a legend in one row, in place.

    Args:
        image: RGB.
        layers: Layers to explain, in this order.
        left: Column at which the row starts, pixels.
        middle: Middle line of the row, pixels.
        size: Height of the em square, pixels.
        gap: Space between entries, in em.

    Returns:
        Column at which the row ends, pixels.
    """
    for layer in layers:
        _SAMPLES[layer](image, left, middle, float(size))
        left += 1.45 * size
        draw_text(image, layer.value, (left, middle), size, color=palette.MUTED)
        left += text_width(layer.value, size) + gap * size
    return left - gap * size


def _cell(color: palette.Rgb) -> _Drawing:
    def draw(image: UInt8[np.ndarray, "_ _ 3"], left: float, middle: float, side: float) -> None:
        half = side / 2.0
        edge = palette.BLOCK if color != palette.OCCUPIED else color
        shapes.rectangle(image, (left, middle - half), (left + side, middle + half), edge)
        shapes.rectangle(
            image,
            (round(left) + 1, round(middle - half) + 1),
            (round(left + side) - 1, round(middle + half) - 1),
            color,
        )

    return draw


def _start(image: UInt8[np.ndarray, "_ _ 3"], left: float, middle: float, side: float) -> None:
    at = (left + side / 2.0, middle)
    shapes.disc(image, at, 0.45 * side, palette.TRAJECTORY_NEW)
    shapes.disc(image, at, 0.2 * side, palette.PAPER)


def _trajectory(image: UInt8[np.ndarray, "_ _ 3"], left: float, middle: float, side: float) -> None:
    for k in range(6):
        color = palette.blend(palette.TRAJECTORY_OLD, palette.TRAJECTORY_NEW, (k + 1) / 6)
        ends = np.array([[left + side * k / 6, middle], [left + side * (k + 1) / 6, middle]])
        shapes.line(image, ends, color, 0.2 * side)


def _robot(image: UInt8[np.ndarray, "_ _ 3"], left: float, middle: float, side: float) -> None:
    draw_robot(image, (left + side / 2.0, middle + 0.1 * side), math.pi / 2.0, 0.75 * side)


def _path(image: UInt8[np.ndarray, "_ _ 3"], left: float, middle: float, side: float) -> None:
    ends = np.array([[left - 0.1 * side, middle], [left + 1.1 * side, middle]])
    dash = 0.32 * side
    shapes.dashed_line(image, ends, palette.PATH, 0.18 * side, dash=dash, gap=0.5 * dash)


def _destination(
    image: UInt8[np.ndarray, "_ _ 3"], left: float, middle: float, side: float
) -> None:
    u, arm = left + side / 2.0, 0.22 * side
    shapes.ring(image, (u, middle), 0.45 * side, palette.PATH, 0.14 * side)
    for slope in (1.0, -1.0):
        ends = np.array([[u - arm, middle - slope * arm], [u + arm, middle + slope * arm]])
        shapes.line(image, ends, palette.PATH, 0.14 * side)


def _tinted(color: palette.Rgb, opacity: float) -> _Drawing:
    def draw(image: UInt8[np.ndarray, "_ _ 3"], left: float, middle: float, side: float) -> None:
        half = side / 2.0
        box = np.array(
            [
                [left, middle - half],
                [left + side, middle - half],
                [left + side, middle + half],
                [left, middle + half],
            ]
        )
        shapes.polygon(image, [box], color, opacity=opacity)
        shapes.line(image, np.rint(box) + 0.5, color, 2.0, closed=True)

    return draw


_SAMPLES: dict[Layer, _Drawing] = {
    Layer.FREE: _cell(palette.FREE),
    Layer.OCCUPIED: _cell(palette.OCCUPIED),
    Layer.UNKNOWN: _cell(palette.UNKNOWN),
    Layer.START: _start,
    Layer.TRAJECTORY: _trajectory,
    Layer.ROBOT: _robot,
    Layer.PATH: _path,
    Layer.DESTINATION: _destination,
    Layer.GOAL: _tinted(palette.GOAL, 0.45),
    Layer.CHOSEN: _tinted(palette.CHOSEN, 0.35),
}
