"""Make the moving images of searches, and the still ones of "How it works".

Run: hypernav find bed --seed 2 --out runs/demo && python scripts/search_images.py runs/demo

With a name it makes a shorter film of a search over stairs, docs/images/NAME.webp:

hypernav eval storeys-train#3018:3019 --episodes 7:8 --save videos --out runs/up
python scripts/search_images.py runs/up/episodes/* stairs-up
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import av
from PIL import Image

from hypernav.core.trace import Mode, StepTrace

_IMAGES = Path(__file__).parents[1] / "docs" / "images"
_MOVING = (800, 450)
_STILL = (1280, 720)
_STILLS = {"look-around": 3, "block": 20, "goal-area": 30, "stop": 37}
"""Name of an image and its step, from 0."""
_EVERY_BEFORE, _MOST_ON_STAIRS, _EVERY_AFTER = 8, 26, 2
"""Steps between two images of a search over stairs, and number of images on the stairs."""


def main(folder: Path) -> None:
    """Write the images of a search."""
    frames = _frames(folder)
    # It begins where the robot sets off: before that it turns, and sees walls.
    first = next(n for n, mode in enumerate(_modes(folder)) if mode is not Mode.LOOK_AROUND)
    _write_moving(frames[first:], _IMAGES / "search.webp", quality=72)
    for name, step in _STILLS.items():
        still = frames[step].resize(_STILL, Image.Resampling.LANCZOS)
        still.save(_IMAGES / f"how-{name}.webp", quality=82, method=6)


def film_of_stairs(folder: Path, name: str) -> None:
    """Write a film in which a search over stairs is on them most of the time."""
    modes = _modes(folder)
    on_stairs = [step for step, mode in enumerate(modes) if mode is Mode.CLIMB]
    first, last = on_stairs[0], on_stairs[-1]
    shown = [
        *range(0, first, _EVERY_BEFORE),
        *range(first, last, max(len(on_stairs) // _MOST_ON_STAIRS, 1)),
        *range(last, len(modes), _EVERY_AFTER),
        len(modes),  # the end card
    ]
    frames = _frames(folder)
    _write_moving([frames[step] for step in shown], _IMAGES / f"{name}.webp", quality=54)


def _modes(folder: Path) -> list[Mode]:
    """The mode of every step."""
    lines = (folder / "trace.jsonl").read_text().splitlines()
    return [StepTrace.model_validate_json(line).mode for line in lines]


def _frames(folder: Path) -> list[Image.Image]:
    """One image a step, and the end card."""
    with av.open(folder / "episode.mp4") as video:
        return [frame.to_image() for frame in video.decode(video=0)]


def _write_moving(frames: Sequence[Image.Image], path: Path, *, quality: int) -> None:
    small = [frame.resize(_MOVING, Image.Resampling.LANCZOS) for frame in frames]
    small[0].save(
        path,
        save_all=True,
        append_images=small[1:],
        duration=[350] * (len(small) - 1) + [3000],
        loop=0,
        quality=quality,
        method=6,
    )


if __name__ == "__main__":
    if len(sys.argv) > 2:
        film_of_stairs(Path(sys.argv[1]), sys.argv[2])
    else:
        main(Path(sys.argv[1]))
