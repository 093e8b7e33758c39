"""Show the maps of two searches side by side as a moving image.

Run: python scripts/before_after.py BEFORE.mp4 AFTER.mp4 IMAGE.webp --captions before after

The videos are those of `hypernav find` or `hypernav eval --save videos`. Both play at the same
pace, a step at a time; the search that ends first stands still at its end.
"""

from itertools import zip_longest
from pathlib import Path
from typing import Annotated

import av
import tyro
from PIL import Image, ImageDraw, ImageOps

from hypernav.show.drawing.palette import INK
from hypernav.show.drawing.text import font

_STATE, _MAP = (680, 0, 1264, 46), (680, 76, 1264, 690)
"""Parts of a frame, pixels (left, top, right, bottom): what the robot does at which step, and
the map with its legend."""
_SCALE = 400 / 584
_CAPTION_PX = 34
_FRAME_MS, _END_MS = 180, 3000
_MOST_FRAMES = 120


def main(
    before: Annotated[Path, tyro.conf.Positional],
    after: Annotated[Path, tyro.conf.Positional],
    image: Annotated[Path, tyro.conf.Positional],
    captions: tuple[str, str] = ("before", "after"),
) -> None:
    """Write the moving image.

    Args:
        before: Video of the one search.
        after: Video of the other.
        image: The moving image, WebP.
        captions: What stands above the two maps.
    """
    videos = _maps(before), _maps(after)
    pairs = list(zip_longest(*videos))
    every = -(-len(pairs) // _MOST_FRAMES)
    shown = [*pairs[:-1:every], pairs[-1]]
    frames = [
        _frame([one or video[-1] for one, video in zip(pair, videos, strict=True)], captions)
        for pair in shown
    ]
    frames[0].save(
        image,
        save_all=True,
        append_images=frames[1:],
        duration=[_FRAME_MS] * (len(frames) - 1) + [_END_MS],
        loop=0,
        quality=60,
        method=6,
    )


def _maps(video: Path) -> list[Image.Image]:
    with av.open(video) as file:
        return [_map(frame.to_image()) for frame in file.decode(video=0)]


def _map(frame: Image.Image) -> Image.Image:
    """The number of the step above the map."""
    parts = [frame.crop(part) for part in (_STATE, _MAP)]
    stacked = Image.new("RGB", (parts[0].width, sum(part.height for part in parts)), "white")
    stacked.paste(parts[0], (0, 0))
    stacked.paste(parts[1], (0, parts[0].height))
    return ImageOps.scale(stacked, _SCALE, Image.Resampling.LANCZOS)


def _frame(maps: list[Image.Image], captions: tuple[str, str]) -> Image.Image:
    width, height = maps[0].size
    frame = Image.new("RGB", (2 * width, height + _CAPTION_PX), "white")
    draw = ImageDraw.Draw(frame)
    for k, (shown, caption) in enumerate(zip(maps, captions, strict=True)):
        draw.text((k * width + 10, 8), caption, fill=INK, font=font(15, bold=True))
        frame.paste(shown, (k * width, _CAPTION_PX))
    return frame


if __name__ == "__main__":
    tyro.cli(main)
