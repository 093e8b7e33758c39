"""Make a film of the first goals of a life: what the robot remembers, and what it must look for.

Run: hypernav eval houses-life-train --episodes 3:4 --save videos --out runs/life
     hypernav eval houses-life-train --episodes 3:4 --fresh-memory --out runs/fresh
     python scripts/life_film.py runs/life runs/fresh docs/images/life.webp

Above the video of every search stands its goal, whether an earlier search of the life saw it, and
how many steps it took, with and without the memory.
"""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import av
import tyro
from PIL import Image, ImageDraw

from hypernav.core.trace import Mode, StepTrace
from hypernav.search.drawing.text import font

_SIZE = (800, 450)
_STRIP_PX = 62
_EVERY = {False: 5, True: 2}
"""Steps between two images, where the robot explores and where it goes to what it remembers."""
_FRAME_MS, _FOUND_MS, _END_MS = 350, 1600, 4000
_COLOURS = {False: "#5b6472", True: "#0b6b4f"}


@dataclass(frozen=True)
class Search:
    """The search for one goal.

    Attributes:
        goal: Its goal.
        outcome: How it ended.
        fresh_steps: Number of steps of the search for it with an empty memory.
        trace: Its steps.
        frames: An image of each of them.
    """

    goal: str
    outcome: str
    fresh_steps: int
    trace: list[StepTrace]
    frames: list[Image.Image]

    @property
    def is_remembered(self) -> bool:
        """Whether the robot goes to where it saw the goal in an earlier search."""
        return self.trace[0].mode is Mode.RECALL

    @property
    def words(self) -> str:
        """How the robot comes to know where the goal is."""
        if self.is_remembered:
            return "seen in an earlier search: goes there"
        if self.trace[0].detections:
            return "in sight from where it stands"
        return "not seen so far: looks for it"


def main(
    run: Annotated[Path, tyro.conf.Positional],
    fresh: Annotated[Path, tyro.conf.Positional],
    film: Annotated[Path, tyro.conf.Positional],
    goals: int = 5,
    quality: int = 50,
) -> None:
    """Write the film.

    Args:
        run: Folder of the run, with the videos of one life.
        fresh: Folder of the run of the same goals, each with an empty memory.
        film: The film, WebP.
        goals: Number of goals to show.
        quality: Quality of the images, 1 to 100.
    """
    folders = sorted((run / "episodes").iterdir(), key=_number_of)
    lines = (fresh / "episodes.jsonl").read_text().splitlines()
    steps = {one["episode_id"]: one["steps"] for one in map(json.loads, lines)}
    searches = [_search(folder, steps) for folder in folders[:goals]]
    images, durations = list[Image.Image](), list[int]()
    for number, search in enumerate(searches):
        shown = [*range(0, len(search.frames), _EVERY[search.is_remembered]), None]
        images += [_image(searches, number, step) for step in shown]
        durations += [_FRAME_MS] * (len(shown) - 1) + [_FOUND_MS]
    durations[-1] = _END_MS
    images[0].save(
        film,
        save_all=True,
        append_images=images[1:],
        duration=durations,
        loop=0,
        quality=quality,
        method=6,
    )
    print(f"{film}: {len(images)} images, {film.stat().st_size / 1000:.0f} kB")


def _number_of(folder: Path) -> int:
    """Number of a goal in its life."""
    return int(_result(folder)["episode"].rpartition(".")[2])


def _result(folder: Path) -> dict[str, Any]:
    return json.loads((folder / "result.json").read_text())


def _search(folder: Path, fresh_steps: dict[str, int]) -> Search:
    lines = (folder / "trace.jsonl").read_text().splitlines()
    trace = [StepTrace.model_validate_json(line) for line in lines]
    with av.open(folder / "episode.mp4") as video:
        frames = [
            frame.to_image().resize(_SIZE, Image.Resampling.LANCZOS)
            for frame in video.decode(video=0)
        ]
    result = _result(folder)
    frames = frames[: len(trace)]  # no end card
    return Search(result["goal"], result["outcome"], fresh_steps[result["episode"]], trace, frames)


def _image(searches: list[Search], number: int, step: int | None) -> Image.Image:
    """An image of a search under what is known of its life; without a step, that of its end."""
    search = searches[number]
    image = Image.new("RGB", (_SIZE[0], _SIZE[1] + _STRIP_PX), "white")
    image.paste(search.frames[-1 if step is None else step], (0, _STRIP_PX))
    draw = ImageDraw.Draw(image)
    draw.rectangle((0, 0, _SIZE[0], 36), fill=_COLOURS[search.is_remembered])
    end = (
        f": {search.outcome} after {len(search.trace)} steps"
        if step is None
        else f", {search.words}"
    )
    head = f"Goal {number + 1}: {search.goal}{end}"
    draw.text((12, 8), head, fill="white", font=font(17, bold=True))
    before = searches[: number + (step is None)]
    took = ", ".join(f"{one.goal} {len(one.trace)} ({one.fresh_steps})" for one in before)
    told = f"steps (and with an empty memory): {took}" if took else "begins with an empty memory"
    draw.text((12, 41), told, fill="black", font=font(13))
    return image


if __name__ == "__main__":
    tyro.cli(main)
