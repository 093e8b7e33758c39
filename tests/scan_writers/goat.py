"""Files of GOAT-Bench, written from the description of their format alone."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from scan_writers.buildings import Corner, House
from scan_writers.episodes import habitat, write_json

Task = Sequence[Any]
"""A row of ``tasks``: category, goal type, object, and what else the files have."""


def goat_object(
    name: str,
    category: str,
    middle: Corner,
    view_points: Sequence[Corner],
    description: str | None = None,
    children: Sequence[str] = (),
) -> dict[str, Any]:
    """One entry of a list in ``goals``."""
    view = {"position": habitat(middle), "rotation": [0.0, 0.0, 0.0, 1.0], "hfov": 90}
    states = [{"position": habitat(p), "rotation": [0.0, 0.0, 0.0, 1.0]} for p in view_points]
    return {
        "object_category": category,
        "object_id": name,
        "position": habitat(middle),
        "view_points": [{"agent_state": state, "radius": 0.5} for state in states],
        "lang_desc": description,
        "image_goals": [view, view],
        "children_object_categories": list(children),
    }


def goat_life(number: int, scene_id: str, start: Corner, tasks: Sequence[Task]) -> dict[str, Any]:
    """One episode; the robot looks along x."""
    return {
        "episode_id": f"file-{number}",
        "scene_id": scene_id,
        "start_position": habitat(start),
        "start_rotation": [0.0, -math.sin(math.pi / 4), 0.0, math.cos(math.pi / 4)],
        "tasks": [list(task) for task in tasks],
    }


def write_goat(
    folder: Path, lives: Sequence[dict[str, Any]], objects: Sequence[dict[str, Any]]
) -> Path:
    """A split: an empty main file, and a file of the scene.

    Args:
        folder: Folder of the split, such as ``…/v1/val_unseen``.
        lives: What `goat_life` gives, all in one scene.
        objects: What `goat_object` gives.
    """
    write_json(folder / f"{folder.name}.json.gz", {"episodes": []})
    basename = Path(lives[0]["scene_id"]).name
    goals: dict[str, list[dict[str, Any]]] = {}
    for one in objects:
        goals.setdefault(f"{basename}_{one['object_category']}", []).append(one)
    content = {"goals": goals, "episodes": list(lives)}
    return write_json(folder / "content" / f"{basename.split('.')[0]}.json.gz", content)


def objects_of(house: House) -> list[dict[str, Any]]:
    """The things of a built house; each is called what it is, "the chair"."""
    found = []
    for number, thing in enumerate(house.things, start=1):
        if thing.task:
            low, high = thing.low, thing.high
            middle = tuple((a + b) / 2.0 for a, b in zip(low, high, strict=True))
            found.append(
                goat_object(
                    f"{thing.category}_{number}",
                    thing.task,
                    (middle[0], middle[1], middle[2]),
                    house.view_points(thing),
                    f"the {thing.category}",
                )
            )
    return found
