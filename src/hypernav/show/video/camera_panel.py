"""Camera image with the detections in it."""

import cv2
import numpy as np
from jaxtyping import UInt8

from hypernav.core.trace import DetectionRecord
from hypernav.show.drawing import palette, shapes
from hypernav.show.drawing.text import draw_text, shortened, text_width

_TEXT = 14
_CHIP_HEIGHT = 22


def draw_camera(
    rgb: UInt8[np.ndarray, "_ _ 3"],
    detections: list[DetectionRecord],
    *,
    width: int,
    height: int,
) -> UInt8[np.ndarray, "_ _ 3"]:
    """Draw a camera image with boxes, mask outlines and labels, fitted into a panel.

    An accepted detection is green; a rejected one is grey, with the reason.

    Args:
        rgb: The camera image.
        detections: Detections in this image.
        width: Width of the panel, pixels.
        height: Height of the panel, pixels.

    Returns:
        RGB, ``height`` by ``width``.
    """
    scale = min(width / rgb.shape[1], height / rgb.shape[0])
    size = (max(round(rgb.shape[1] * scale), 1), max(round(rgb.shape[0] * scale), 1))
    smaller = scale < 1.0
    image = (
        rgb.copy()
        if size == rgb.shape[1::-1]
        else cv2.resize(rgb, size, interpolation=cv2.INTER_AREA if smaller else cv2.INTER_LINEAR)
    )
    for detection in sorted(detections, key=lambda each: (each.accepted, each.score)):
        _draw_detection(image, detection, scale)
    panel = np.full((height, width, 3), palette.OCCUPIED, dtype=np.uint8)
    top, left = (height - size[1]) // 2, (width - size[0]) // 2
    panel[top : top + size[1], left : left + size[0]] = image
    return panel


def _draw_detection(
    image: UInt8[np.ndarray, "_ _ 3"], detection: DetectionRecord, scale: float
) -> None:
    color = palette.GOAL if detection.accepted else palette.BLOCK
    outlines = [np.array(outline, dtype=np.float64) * scale for outline in detection.outlines]
    shapes.polygon(image, outlines, color, opacity=0.35)
    for outline in outlines:
        shapes.line(image, outline, palette.PAPER, 1.0, closed=True)
    left, top, right, bottom = (value * scale for value in detection.box)
    corners = np.array([[left, top], [right, top], [right, bottom], [left, bottom], [left, top]])
    if detection.accepted:
        shapes.line(image, corners, palette.PAPER, 5.0)
        shapes.line(image, corners, color, 3.0)
    else:
        shapes.line(image, corners, color, 2.0)
        shapes.dashed_line(image, corners, palette.PAPER, 2.0, dash=8.0, gap=8.0)
    _draw_label(image, _label(detection), left, top, color)


def _label(detection: DetectionRecord) -> str:
    label = f"{detection.label} {detection.score:.2f}"
    if detection.accepted:
        return label
    return f"{label} · {detection.reason or 'not accepted'}"


def _draw_label(
    image: UInt8[np.ndarray, "_ _ 3"], text: str, left: float, top: float, color: palette.Rgb
) -> None:
    height, width = image.shape[:2]
    text = shortened(text, _TEXT, width - 16.0, bold=True)
    chip = text_width(text, _TEXT, bold=True) + 14.0
    u = min(max(left - 1.5, 0.0), max(width - chip, 0.0))
    above = top - _CHIP_HEIGHT
    v = above if above >= 0.0 else min(max(top, 0.0), height - float(_CHIP_HEIGHT))
    shapes.rectangle(image, (u, v), (u + chip, v + _CHIP_HEIGHT), color)
    at = (u + 7.0, v + _CHIP_HEIGHT / 2.0)
    draw_text(image, text, at, _TEXT, bold=True, color=palette.ink_on(color))
