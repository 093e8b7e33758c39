"""Episode files of every published kind, as habitat-lab's own generators write them."""

import gzip
import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from scan_writers.buildings import Corner, House, Thing

SCENE = "00802-wcojb4TFT35"
HASH = "wcojb4TFT35"


def habitat(point: Corner) -> list[float]:
    """A position y up, as the files have it."""
    return [point[0], point[2], -point[1]]


def goals_of(house: House, category: str, *, textual: bool = False) -> list[dict[str, Any]]:
    """All things of a task category with their view points."""
    return [
        _goal(house, thing, number, textual=textual)
        for number, thing in enumerate(house.things, start=1)
        if thing.task == category
    ]


def episode(
    number: int, scene_id: str, category: str, start: Corner, yaw: float = 0.0, **more: Any
) -> dict[str, Any]:
    """One episode; yaw is counted from x, as everywhere here."""
    half = (yaw - math.pi / 2.0) / 2.0
    return {
        "episode_id": str(number),
        "scene_id": scene_id,
        "scene_dataset_config": "./data/scene_datasets/hm3d/x.scene_dataset_config.json",
        "additional_obj_config_paths": [],
        "start_position": habitat(start),
        "start_rotation": [0.0, math.sin(half), 0.0, math.cos(half)],
        "info": {"geodesic_distance": 3.0, "euclidean_distance": 2.0},
        "goals": [],
        "start_room": None,
        "shortest_paths": None,
        "object_category": category,
        **more,
    }


def write_json(path: Path, content: Any) -> Path:
    """A compressed file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(gzip.compress(json.dumps(content).encode()))
    return path


def write_split(
    folder: Path, house: House, episodes: Sequence[dict[str, Any]], *, textual: bool = False
) -> Path:
    """A split with an empty main file and one file of a scene.

    Args:
        folder: Folder of the split, such as ``…/v1/val``.
        house: Building that the goals are in.
        episodes: Episodes, all in one scene.
        textual: Whether objects have text for a number, as in OVON.
    """
    main: dict[str, Any] = {"episodes": []}
    ids = {"chair": 0, "bed": 1, "plant": 2, "toilet": 3, "tv_monitor": 4, "sofa": 5}
    numbers = {} if textual else {"category_to_task_category_id": ids}
    if not textual:
        main |= numbers
    write_json(folder / f"{folder.name}.json.gz", main)
    basename = Path(episodes[0]["scene_id"]).name
    tasks = {thing.task for thing in house.things if thing.task}
    content = {
        "goals_by_category": {
            f"{basename}_{task}": goals_of(house, task, textual=textual) for task in sorted(tasks)
        },
        "episodes": list(episodes),
        **numbers,
    }
    return write_json(folder / "content" / f"{basename.split('.')[0]}.json.gz", content)


def _goal(house: House, thing: Thing, number: int, *, textual: bool) -> dict[str, Any]:
    middle = tuple((low + high) / 2.0 for low, high in zip(thing.low, thing.high, strict=True))
    name = f"{thing.category}_{number}"
    states = [
        {"position": habitat(point), "rotation": [0.0, 0.0, 0.0, 1.0]}
        for point in house.view_points(thing)
    ]
    points = [{"agent_state": s} | ({} if textual else {"iou": 0.1}) for s in states]
    return {
        "position": habitat((middle[0], middle[1], middle[2])),
        "radius": None,
        "object_id": name if textual else number,
        "object_name": name,
        "object_name_id": None,
        "object_category": thing.task,
        "room_id": None,
        "room_name": None,
        "view_points": points,
    }
