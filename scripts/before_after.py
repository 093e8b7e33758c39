"""Show the maps of two searches side by side as a moving image.

Run: python scripts/before_after.py FOLDER FOLDER IMAGE.webp --captions before after

The folders are those of searches, by `hypernav find` or `hypernav eval --save videos`. Both play at
the same pace; the search that ends first stands still at its end.
"""

from pathlib import Path
from typing import Annotated

import av
import tyro
from PIL import Image, ImageDraw, ImageOps

from hypernav.search.drawing.palette import INK
from hypernav.search.drawing.text import font

_STATE, _MAP = (680, 0, 1264, 40), (680, 76, 1264, 690)
"""Parts of a frame, pixels (left, top, right, bottom): what the robot does at which step, and
the map with its legend."""
_SCALE = 400 / 584
_CAPTION_PX = 34
_FRAME_MS, _END_MS = 180, 3000
_MOST_FRAMES = 80
_END_FRAMES = 2
"""Frames of a video that show the card at its end."""


def main(
    before: Annotated[Path, tyro.conf.Positional],
    after: Annotated[Path, tyro.conf.Positional],
    image: Annotated[Path, tyro.conf.Positional],
    captions: tuple[str, str] = ("before", "after"),
) -> None:
    """Write the moving image.

    Args:
        before: Folder of the one search.
        after: Folder of the other.
        image: The moving image, WebP.
        captions: What stands above the two maps.
    """
    searches = _maps(before), _maps(after)
    steps = max(len(maps) for maps in searches)
    shown = [*range(0, steps - 1, -(-steps // _MOST_FRAMES)), steps - 1]
    frames = [_frame(searches, captions, step) for step in shown]
    frames[0].save(
        image,
        save_all=True,
        append_images=frames[1:],
        duration=[_FRAME_MS] * (len(frames) - 1) + [_END_MS],
        loop=0,
        quality=55,
        method=6,
    )


def _maps(search: Path) -> list[Image.Image]:
    """The map at every step of a search."""
    with av.open(search / "episode.mp4") as video:
        return [_map(frame.to_image()) for frame in video.decode(video=0)][:-_END_FRAMES]


def _map(frame: Image.Image) -> Image.Image:
    """The number of the step above the map."""
    parts = [frame.crop(part) for part in (_STATE, _MAP)]
    stacked = Image.new("RGB", (parts[0].width, sum(part.height for part in parts)), "white")
    stacked.paste(parts[0], (0, 0))
    stacked.paste(parts[1], (0, parts[0].height))
    return ImageOps.scale(stacked, _SCALE, Image.Resampling.LANCZOS)


def _frame(
    searches: tuple[list[Image.Image], list[Image.Image]], captions: tuple[str, str], step: int
) -> Image.Image:
    width, height = searches[0][0].size
    frame = Image.new("RGB", (2 * width, height + _CAPTION_PX), "white")
    draw = ImageDraw.Draw(frame)
    for left, maps, caption in zip((0, width), searches, captions, strict=True):
        text = caption if step < len(maps) - 1 else f"{caption}: {len(maps)} steps"
        draw.text((left + 10, 8), text, fill=INK, font=font(15, bold=True))
        frame.paste(maps[min(step, len(maps) - 1)], (left, _CAPTION_PX))
    return frame


if __name__ == "__main__":
    tyro.cli(main)
