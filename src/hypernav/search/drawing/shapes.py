"""Anti-aliased lines and shapes on images, at fractions of a pixel; the robot; numbered arrows.

Coordinates are as in `MapView`: pixel column c covers ``[c, c + 1)``.
"""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float64, Int32, UInt8

from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Transform
from hypernav.search.drawing import palette
from hypernav.search.drawing.palette import Rgb
from hypernav.search.drawing.text import draw_text, text_width

_SHIFT = 4
# OpenCV measures from the centre of the first pixel, and draws with 32-bit integers.
_HALF = 0.5
_FARTHEST = 1e7

Image = UInt8[np.ndarray, "_ _ 3"]
"""RGB."""
Points = Float64[np.ndarray, "_ 2"]
"""Pixel coordinates ``(u, v)``."""

# Tip, left wing, notch, right wing, as shares of the arrow's radius; x is ahead.
_ROBOT_CORNERS = np.array([[1.0, 0.0], [-0.76, 0.64], [-0.38, 0.0], [-0.76, -0.64]])

_RED: palette.Rgb = (214, 32, 32)
_LINES = 1080.0
"""Height of the image that sizes are given for, pixels; they scale with the image."""
_FARTHEST_FOOT = 4.0
"""Image row, in image heights, beyond which the robot's foot counts as out of sight."""


def _fixed(points: Points) -> Int32[np.ndarray, "_ 2"]:
    bounded = np.clip(points - _HALF, -_FARTHEST, _FARTHEST)
    return np.rint(bounded * (1 << _SHIFT)).astype(np.int32)


def line(image: Image, points: Points, color: Rgb, width: float, *, closed: bool = False) -> None:
    """Draw a line through points, with round corners, in place."""
    if len(points) >= 2:
        thickness = max(round(width), 1)
        cv2.polylines(image, [_fixed(points)], closed, color, thickness, cv2.LINE_AA, _SHIFT)


def dashes(points: Points, dash: float, gap: float) -> list[Points]:
    """The drawn pieces of a dashed line.

    Args:
        points: Corners of the line.
        dash: Length of a piece, pixels.
        gap: Length of the space after it.

    Returns:
        The corners of each piece.
    """
    steps = np.hypot(*np.diff(points, axis=0).T)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    starts = np.arange(0.0, along[-1], dash + gap)
    pieces = []
    for start in starts:
        end = min(start + dash, along[-1])
        inner = along[(along > start) & (along < end)]
        at = np.concatenate([[start], inner, [end]])
        pieces.append(np.stack([np.interp(at, along, points[:, k]) for k in (0, 1)], axis=1))
    return pieces


def dashed_line(
    image: Image, points: Points, color: Rgb, width: float, *, dash: float, gap: float
) -> None:
    """Draw a dashed line through points, in place."""
    for piece in dashes(points, dash, gap) if len(points) >= 2 else []:
        line(image, piece, color, width)


def polygon(image: Image, outlines: Sequence[Points], color: Rgb, *, opacity: float = 1.0) -> None:
    """Fill polygons, in place. Areas that an even number of them cover stay empty."""
    corners = [_fixed(outline) for outline in outlines if len(outline) >= 3]
    if not corners:
        return
    if opacity >= 1.0:
        cv2.fillPoly(image, corners, color, cv2.LINE_AA, _SHIFT)
        return
    everything = np.concatenate([outline for outline in outlines if len(outline) >= 3])
    left, top, right, bottom = _window(image, everything)
    if left < right and top < bottom:
        cover = np.zeros((bottom - top, right - left), dtype=np.uint8)
        move = np.array([left, top], dtype=np.int32) << _SHIFT
        cv2.fillPoly(cover, [outline - move for outline in corners], 255, cv2.LINE_AA, _SHIFT)
        tint(image[top:bottom, left:right], cover, color, opacity)


def rectangle(
    image: Image,
    corner: tuple[float, float],
    opposite: tuple[float, float],
    color: Rgb,
    *,
    opacity: float = 1.0,
) -> None:
    """Fill an upright rectangle of whole pixels, in place."""
    (left, right), (top, bottom) = (
        sorted((round(a), round(b))) for a, b in zip(corner, opposite, strict=True)
    )
    if left == right or top == bottom:
        return
    if opacity >= 1.0:
        cv2.rectangle(image, (left, top), (right - 1, bottom - 1), color, cv2.FILLED)
        return
    part = image[max(top, 0) : max(bottom, 0), max(left, 0) : max(right, 0)]
    if part.size:
        cover = np.full(part.shape[:2], 255, dtype=np.uint8)
        tint(part, cover, color, opacity)


def disc(image: Image, centre: tuple[float, float], radius: float, color: Rgb) -> None:
    """Fill a disc, in place."""
    polygon(image, [_circle(centre, radius)], color)


def ring(
    image: Image, centre: tuple[float, float], radius: float, color: Rgb, width: float
) -> None:
    """Draw a circle, in place."""
    line(image, _circle(centre, radius), color, width, closed=True)


def _circle(centre: tuple[float, float], radius: float) -> Points:
    # OpenCV's own circles are jagged when small.
    turn = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
    return np.stack([centre[0] + radius * np.cos(turn), centre[1] + radius * np.sin(turn)], axis=1)


def rounded_box(
    image: Image,
    left: float,
    top: float,
    width: float,
    height: float,
    color: Rgb,
    *,
    radius: float,
) -> None:
    """Fill a rectangle with round corners, in place."""
    radius = min(radius, width / 2.0, height / 2.0)
    turn = np.linspace(0.0, np.pi / 2.0, 9)
    corners = []
    for quarter, (u, v) in enumerate(
        [
            (left + width - radius, top + height - radius),
            (left + radius, top + height - radius),
            (left + radius, top + radius),
            (left + width - radius, top + radius),
        ]
    ):
        angle = turn + quarter * np.pi / 2.0
        corners.append(np.stack([u + radius * np.cos(angle), v + radius * np.sin(angle)], axis=1))
    polygon(image, [np.concatenate(corners)], color)


def tint(part: Image, cover: UInt8[np.ndarray, "_ _"], color: Rgb, opacity: float) -> None:
    """Mix a colour into an image where a mask covers it, in place."""
    share = cover.astype(np.float32) * (opacity / 255.0)
    away = np.array(color, dtype=np.float32) - part
    part[...] = np.rint(part + away * share[..., None]).astype(np.uint8)


def hatch(
    image: Image,
    corner: tuple[float, float],
    opposite: tuple[float, float],
    color: Rgb,
    *,
    spacing: int,
    opacity: float,
) -> None:
    """Hatch an upright rectangle with diagonals, in place.

    The diagonals of neighbouring rectangles meet.
    """
    (left, right), (top, bottom) = (
        sorted((max(round(a), 0), max(round(b), 0))) for a, b in zip(corner, opposite, strict=True)
    )
    part = image[top:bottom, left:right]
    if part.size:
        v, u = np.mgrid[top : top + part.shape[0], left : left + part.shape[1]]
        stripes: Bool[np.ndarray, "_ _"] = (u + v) % spacing < max(spacing // 4, 1)
        tint(part, stripes.astype(np.uint8) * np.uint8(255), color, opacity)


def _window(image: Image, points: Points) -> tuple[int, int, int, int]:
    """Whole-pixel bounds of points, clipped to the image: left, top, right, bottom."""
    lowest, highest = points.min(axis=0) - 2.0, points.max(axis=0) + 2.0
    height, width = image.shape[:2]
    return (
        int(np.clip(np.floor(lowest[0]), 0, width)),
        int(np.clip(np.floor(lowest[1]), 0, height)),
        int(np.clip(np.ceil(highest[0]), 0, width)),
        int(np.clip(np.ceil(highest[1]), 0, height)),
    )


def draw_robot(
    image: UInt8[np.ndarray, "_ _ 3"], at: tuple[float, float], yaw: float, radius: float
) -> None:
    """Draw a robot, in place.

    Args:
        image: RGB.
        at: Centre of the arrow, pixels.
        yaw: Heading, radians counter-clockwise from the image's right.
        radius: Radius of the disc that holds the arrow, pixels.
    """
    c, s = math.cos(yaw), math.sin(yaw)
    turned = np.stack([_ROBOT_CORNERS @ (c, -s), -(_ROBOT_CORNERS @ (s, c))], axis=1)
    rim = np.array(at) + turned * (radius - 1.0)
    polygon(image, [rim], palette.FREE)
    line(image, rim, palette.FREE, 3.0, closed=True)
    polygon(image, [np.array(at) + turned * (radius - 3.0)], palette.ROBOT)


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
        line(drawn, np.array([foot, pixel]), color, max(style.shaft_px * scale, 1.0))
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
    disc(image, centre, radius, _RED)
    disc(image, centre, radius - max(style.shaft_px * scale, 1.5), fill)
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
        rectangle(image, (2.0, top), (2.0 + width, top + size + 6.0), palette.PAPER)
        at = (5.0, top + size / 2.0 + 3.0)
        draw_text(image, word, at, size, bold=True, color=_RED)
