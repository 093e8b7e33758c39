"""Numbered arrows on a camera image, for a model and for people."""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import UInt8

from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Transform
from hypernav.show.drawing import palette, shapes
from hypernav.show.drawing.text import draw_text, text_width

_RED: palette.Rgb = (214, 32, 32)
_LINES = 1080.0
"""Height of the image that sizes are given for, pixels; they scale with the image."""
_FARTHEST_FOOT = 4.0
"""Image row, in image heights, beyond which the robot's foot counts as out of sight."""


@dataclass(frozen=True)
class ArrowStyle:
    """Sizes at an image height of 1080 pixels, as VLMnav draws; ours for the disc and its number.

    Attributes:
        shafts: Whether lines are drawn from the robot's foot to the marks.
        shaft_px: Width of these lines, pixels.
        disc_px: Radius of the discs, pixels.
        text_px: Height of the numbers, pixels.
    """

    shafts: bool = True
    shaft_px: float = 5.0
    disc_px: float = 34.0
    text_px: float = 44.0

    def radius_px(self, height: int) -> float:
        """Radius of a disc, pixels, in an image with a number of rows."""
        return max(self.disc_px * height / _LINES, 7.0)


def draw_arrows(
    image: UInt8[np.ndarray, "height width 3"],
    marks: Mapping[int, tuple[float, float]],
    foot: tuple[float, float],
    style: ArrowStyle,
    *,
    may_turn: bool = False,
    chosen: Collection[int] = (),
) -> UInt8[np.ndarray, "height width 3"]:
    """Draw a red line from the robot's foot to each mark, and a white disc with its number.

    Args:
        image: Camera image, which is not changed.
        marks: Image coordinates ``(u, v)`` of the marks by their numbers.
        foot: Image coordinates of the robot's foot, see `foot_pixel`.
        style: Sizes.
        may_turn: Whether the left edge says that 0 turns around.
        chosen: Numbers of arrows that are drawn as chosen, for people.

    Returns:
        RGB, of the size of the image.
    """
    drawn = image.copy()
    scale = drawn.shape[0] / _LINES
    for number, pixel in marks.items() if style.shafts else ():
        color = palette.CHOSEN if number in chosen else _RED
        shapes.line(drawn, np.array([foot, pixel]), color, max(style.shaft_px * scale, 1.0))
    for number, pixel in marks.items():
        fill = palette.CHOSEN if number in chosen else palette.PAPER
        _draw_disc(drawn, pixel, str(number), style, scale, fill)
    if may_turn:
        _draw_turn(drawn, style, scale)
    return drawn


def foot_pixel(camera: PinholeCamera, camera_to_base: Transform) -> tuple[float, float]:
    """Image coordinates of the floor under the robot, or the middle of the lower edge.

    The latter is for a foot that is far below the image or, as for a level camera, nowhere in it.
    """
    foot = camera_to_base.inverse().apply(np.zeros((1, 3)))
    u, v = camera.project(foot)[0]
    if not math.isfinite(v) or v > _FARTHEST_FOOT * camera.height:
        return camera.cx, float(camera.height)
    return float(u), float(v)


def _draw_disc(
    image: UInt8[np.ndarray, "_ _ 3"],
    centre: tuple[float, float],
    text: str,
    style: ArrowStyle,
    scale: float,
    fill: palette.Rgb,
) -> None:
    radius = style.radius_px(image.shape[0])
    shapes.disc(image, centre, radius, _RED)
    shapes.disc(image, centre, radius - max(style.shaft_px * scale, 1.5), fill)
    size = max(round(style.text_px * scale), 10)
    draw_text(image, text, centre, size, bold=True, color=palette.INK, align=0.5)


def _draw_turn(image: UInt8[np.ndarray, "_ _ 3"], style: ArrowStyle, scale: float) -> None:
    """Say at the left edge that 0 turns around."""
    radius = style.radius_px(image.shape[0])
    middle = image.shape[0] / 2.0
    _draw_disc(image, (radius + 4.0, middle), "0", style, scale, palette.PAPER)
    size = max(round(style.text_px * scale * 0.7), 9)
    for row, word in enumerate(("TURN", "AROUND")):
        width = text_width(word, size, bold=True) + 6.0
        top = middle + radius + 4.0 + row * (size + 6.0)
        shapes.rectangle(image, (2.0, top), (2.0 + width, top + size + 6.0), palette.PAPER)
        at = (5.0, top + size / 2.0 + 3.0)
        draw_text(image, word, at, size, bold=True, color=_RED)
