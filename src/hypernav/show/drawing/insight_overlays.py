"""What an explorer looked at, drawn over the map: its values of the floor, and its things."""

import cv2
import numpy as np
from jaxtyping import UInt8

from hypernav.core.exploring.floors import SeenThing
from hypernav.core.exploring.insight import ThingGraph, ValueImage
from hypernav.show.drawing import palette, shapes
from hypernav.show.drawing.map_painter import MapPainter
from hypernav.show.drawing.map_view import MapView
from hypernav.show.drawing.text import draw_text, text_width

_LOW: palette.Rgb = (38, 70, 160)
_HIGH: palette.Rgb = (240, 200, 40)
_OPACITY = 0.45
_BAR = (96, 10)
_WORDS = 12


def _color_table() -> UInt8[np.ndarray, "256 3"]:
    shares = np.linspace(0.0, 1.0, 256)
    return np.array([palette.blend(_LOW, _HIGH, float(share)) for share in shares], np.uint8)


_COLORS = _color_table()


def draw_values(image: UInt8[np.ndarray, "_ _ 3"], view: MapView, values: ValueImage) -> None:
    """Tint the floor that has a value, from blue for the lowest to yellow for the highest.

    Args:
        image: Image of the map, changed in place.
        view: Metres to pixels.
        values: Values of the floor.
    """
    grades = values.grades
    if not grades.any():
        return
    known = grades[grades > 0]
    low, high = int(known.min()), int(known.max())
    scaled = np.clip((grades.astype(np.float32) - low) / max(high - low, 1) * 255.0, 0.0, 255.0)
    # From pixels of the image to cells of the values; y points up in the map, down in the image.
    per_pixel = 1.0 / (view.pixels_per_m * values.cell_m)
    left = (view.left_m - values.x_min) / values.cell_m
    top = (view.top_m - values.y_min) / values.cell_m
    middle = 0.5 * per_pixel - 0.5
    matrix = np.array([[per_pixel, 0.0, left + middle], [0.0, -per_pixel, top - middle - 1.0]])
    size = (image.shape[1], image.shape[0])
    flags = cv2.INTER_NEAREST | cv2.WARP_INVERSE_MAP
    cover = cv2.warpAffine((grades > 0).astype(np.uint8), matrix, size, flags=flags) > 0
    shades = np.asarray(cv2.warpAffine(scaled.astype(np.uint8), matrix, size, flags=flags))
    colors = _COLORS[shades.astype(np.intp)]
    mixed = (1.0 - _OPACITY) * image + _OPACITY * colors
    image[cover] = np.rint(mixed[cover]).astype(np.uint8)
    _draw_bar(image, (low - 1) / 254.0, (high - 1) / 254.0)


def _draw_bar(image: UInt8[np.ndarray, "_ _ 3"], low: float, high: float) -> None:
    """Draw the colour scale in the upper left corner."""
    width, height = _BAR
    words = [f"value {low:.2f}", f"{high:.2f}"]
    left = 10.0 + text_width(words[0], _WORDS) + 6.0
    right = left + width + 6.0 + text_width(words[1], _WORDS) + 6.0
    shapes.rectangle(image, (4.0, 4.0), (right, 24.0), palette.PAPER, opacity=0.8)
    draw_text(image, words[0], (10.0, 14.0), _WORDS, color=palette.INK)
    draw_text(image, words[1], (left + width + 6.0, 14.0), _WORDS, color=palette.INK)
    bar = np.repeat(_COLORS[np.linspace(0, 255, width).astype(int)][None], height, axis=0)
    part = image[9 : 9 + height, round(left) : round(left) + width]
    part[:] = bar[: part.shape[0], : part.shape[1]]


def draw_graph(painter: MapPainter, graph: ThingGraph) -> None:
    """Draw dots for things, lines between near ones, and names of those that the reasoner is told.

    Args:
        painter: Painter of the map.
        graph: The things.
    """
    at = [painter.view.pixel_of(*thing.position) for thing in graph.things]
    unit = painter.view.size / 768.0
    for a, b in graph.near:
        shapes.line(painter.image, np.array([at[a], at[b]]), palette.BLOCK, 1.2 * unit)
    for middle in at:
        shapes.disc(painter.image, middle, max(4.0 * unit, 2.5), palette.BLOCK)
    painter.labels([SeenThing(one.label, one.position) for one in graph.things if one.told])
