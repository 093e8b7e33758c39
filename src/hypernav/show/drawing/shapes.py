"""Anti-aliased lines and shapes on images, at fractions of a pixel.

Coordinates are as in `MapView`: pixel column c covers ``[c, c + 1)``.
"""

from collections.abc import Sequence

import cv2
import numpy as np
from jaxtyping import Bool, Float64, Int32, UInt8

from hypernav.show.drawing.palette import Rgb

_SHIFT = 4
# OpenCV measures from the centre of the first pixel, and draws with 32-bit integers.
_HALF = 0.5
_FARTHEST = 1e7

Image = UInt8[np.ndarray, "_ _ 3"]
"""RGB."""
Points = Float64[np.ndarray, "_ 2"]
"""Pixel coordinates ``(u, v)``."""


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
