"""Make the moving image of the README and the still ones of "How it works" out of a search.

Run: hypernav find bed --seed 2 --out runs/demo && python scripts/search_images.py runs/demo
"""

import sys
from pathlib import Path

import av
from PIL import Image

_IMAGES = Path(__file__).parents[1] / "docs" / "images"
_MOVING = (800, 450)
_STILL = (1280, 720)
_STILLS = {"look-around": 3, "block": 20, "goal-area": 30, "stop": 37}
"""Name of an image and its step, from 0."""


def main(folder: Path) -> None:
    """Write the images of a search."""
    with av.open(folder / "episode.mp4") as video:
        frames = [frame.to_image() for frame in video.decode(video=0)]
    small = [frame.resize(_MOVING, Image.Resampling.LANCZOS) for frame in frames]
    small[0].save(
        _IMAGES / "search.webp",
        save_all=True,
        append_images=small[1:],
        duration=[350] * (len(small) - 1) + [3000],
        loop=0,
        quality=72,
        method=6,
    )
    for name, step in _STILLS.items():
        still = frames[step].resize(_STILL, Image.Resampling.LANCZOS)
        still.save(_IMAGES / f"how-{name}.webp", quality=82, method=6)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
