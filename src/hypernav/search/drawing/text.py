"""Anti-aliased text on images, fast enough for video.

Text is drawn with DejaVu Sans, which matplotlib includes. A drawn line is cached as a mask,
so that text repeated from frame to frame costs only a blend.
"""

import math
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, UInt8
from PIL import Image, ImageDraw, ImageFont

from hypernav.search.drawing.palette import INK, Rgb

_ELLIPSIS = "…"
_LONGEST = 2000


@lru_cache(maxsize=1)
def _font_folder() -> Path:
    # Found without importing matplotlib, which takes much of a second.
    spec = find_spec("matplotlib")
    if spec is None or not spec.submodule_search_locations:
        raise ModuleNotFoundError("matplotlib, a dependency of hypernav, is not installed")
    return Path(next(iter(spec.submodule_search_locations))) / "mpl-data" / "fonts" / "ttf"


@lru_cache(maxsize=64)
def font(size: int, *, bold: bool = False) -> ImageFont.FreeTypeFont:
    """DejaVu Sans.

    Args:
        size: Height of the em square, pixels.
        bold: Whether to use the bold weight.
    """
    name = "DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf"
    return ImageFont.truetype(str(_font_folder() / name), size)


def one_line(text: str) -> str:
    """The text with single spaces and nothing that cannot be printed."""
    spaced = " ".join(text[:_LONGEST].split())
    return "".join(letter for letter in spaced if letter.isprintable())


@lru_cache(maxsize=4096)
def text_width(text: str, size: int, *, bold: bool = False) -> float:
    """Width of a line of text, pixels."""
    return font(size, bold=bold).getlength(text)


@lru_cache(maxsize=2048)
def shortened(text: str, size: int, width: float, *, bold: bool = False) -> str:
    """The text on one line, cut with an ellipsis if it is wider than ``width`` pixels."""
    line = one_line(text)
    if text_width(line, size, bold=bold) <= width:
        return line
    fits, too_long = 0, len(line)
    while too_long - fits > 1:
        middle = (fits + too_long) // 2
        cut = line[:middle].rstrip() + _ELLIPSIS
        fits, too_long = (middle, too_long) if _fits(cut, size, width, bold) else (fits, middle)
    return line[:fits].rstrip() + _ELLIPSIS


def _fits(text: str, size: int, width: float, bold: bool) -> bool:
    return font(size, bold=bold).getlength(text) <= width


@lru_cache(maxsize=512)
def wrapped(
    text: str, size: int, width: float, *, lines: int, bold: bool = False
) -> tuple[str, ...]:
    """The text wrapped into at most ``lines`` lines, the last one cut with an ellipsis if needed.

    A word wider than a line is split at the end of the line.
    """
    broken: list[str] = []
    rest = one_line(text)
    while rest and len(broken) < lines - 1:
        if _fits(rest, size, width, bold):
            break
        line, rest = _first_line(rest, size, width, bold)
        broken.append(line)
    if rest:
        broken.append(shortened(rest, size, width, bold=bold))
    return tuple(broken)


def _first_line(text: str, size: int, width: float, bold: bool) -> tuple[str, str]:
    fits, too_long = 1, len(text)
    while too_long - fits > 1:
        middle = (fits + too_long) // 2
        inside = _fits(text[:middle], size, width, bold)
        fits, too_long = (middle, too_long) if inside else (fits, middle)
    space = text.rfind(" ", 0, fits + 1)
    end = space if space > 0 else fits
    return text[:end].rstrip(), text[end:].lstrip()


class _Stamp(NamedTuple):
    """A drawn line of text, ready to be blended into an image.

    Attributes:
        keep: Share of the image that remains visible, 0 to 1.
        color: Colour added to the image.
        left: Column of the start of the text.
        middle: Row of the middle of the capital letters.
    """

    keep: Float32[np.ndarray, "height width 1"]
    color: Float32[np.ndarray, "height width 3"]
    left: int
    middle: int


@lru_cache(maxsize=1024)
def _stamp(
    text: str, size: int, bold: bool, color: Rgb, halo: Rgb | None, halo_px: int, opacity: float
) -> _Stamp:
    face = font(size, bold=bold)
    ascent, descent = face.getmetrics()
    rim = halo_px + 1
    width = math.ceil(face.getlength(text)) + 2 * rim
    layer = Image.new("L", (width, ascent + descent + 2 * rim))
    keep = np.ones((layer.height, layer.width, 1), dtype=np.float32)
    added = np.zeros((layer.height, layer.width, 3), dtype=np.float32)
    for ink, stroke in ((halo, halo_px), (color, 0)):
        if ink is not None:
            layer.paste(0, (0, 0, layer.width, layer.height))
            draw = ImageDraw.Draw(layer)
            draw.text((rim, rim), text, fill=255, font=face, stroke_width=stroke)
            cover = np.asarray(layer, dtype=np.float32)[..., None] * (opacity / 255.0)
            keep *= 1.0 - cover
            added += (np.array(ink, dtype=np.float32) - added) * cover
    inked = np.argwhere(keep[..., 0] < 1.0)
    if not inked.size:
        return _Stamp(keep[:0, :0], added[:0, :0], 0, 0)
    top, left = (int(k) for k in inked.min(axis=0))
    bottom, right = (int(k) + 1 for k in inked.max(axis=0))
    # DejaVu's capitals are 0.73 em high and stand on the baseline.
    middle = round(rim + ascent - 0.365 * size)
    return _Stamp(
        keep[top:bottom, left:right], added[top:bottom, left:right], rim - left, middle - top
    )


def draw_text(
    image: UInt8[np.ndarray, "_ _ 3"],
    text: str,
    at: tuple[float, float],
    size: int,
    *,
    color: Rgb = INK,
    bold: bool = False,
    align: float = 0.0,
    halo: Rgb | None = None,
    halo_px: int = 2,
    opacity: float = 1.0,
) -> None:
    """Write one line of text onto an image, in place; parts outside are cut off.

    Args:
        image: RGB.
        text: One line.
        at: Pixel ``(x, y)``: y is the middle of the capital letters, x the start, middle or end.
        size: Height of the em square, pixels.
        color: Colour of the letters.
        bold: Whether to use the bold weight.
        align: 0 if the text starts at x, 0.5 if it is centred there, 1 if it ends there.
        halo: Colour of a rim around the letters, for uneven ground.
        halo_px: Width of the rim.
        opacity: Opacity of text and rim, 0 to 1.
    """
    if not text:
        return
    x = at[0] - align * text_width(text, size, bold=bold)
    rim = halo_px if halo is not None else 0
    stamp = _stamp(text, size, bold, color, halo, rim, opacity)
    left, top = round(x) - stamp.left, round(at[1]) - stamp.middle
    bottom, right = top + stamp.keep.shape[0], left + stamp.keep.shape[1]
    part = image[max(top, 0) : max(bottom, 0), max(left, 0) : max(right, 0)]
    if part.size:
        rows = slice(max(-top, 0), max(-top, 0) + part.shape[0])
        columns = slice(max(-left, 0), max(-left, 0) + part.shape[1])
        mixed = part * stamp.keep[rows, columns]
        mixed += stamp.color[rows, columns]
        part[...] = mixed + 0.5
