"""Folders with the memory of a robot that has looked around in a hall, made in a moment."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from box_views import CAMERA, room, view_of
from hypernav.core.embodiment import Embodiment
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.stairs.connectors import Connector, Passage
from hypernav.search.memory.floor import counted_from
from hypernav.search.memory.store.memory_folder import MemoryFolder

HALL = [*room(8.0, 6.0), ((4.0, 0.0, 0.0), (4.2, 4.0, 2.5)), ((1.0, 0.3, 0.0), (2.0, 1.0, 0.8))]
STAIRS = (
    Connector(0, True, (3.5, 1.0), 0.3, Passage.USED, 1, 5),
    Connector(1, False, (5.5, 1.0), -2.8, Passage.USED, 0, 2),
    Connector(1, True, (2.5, 3.0), 1.5, Passage.REFUTED, None, 3),
)


def opened(folder: Path, mapping: MappingConfig | None = None) -> MemoryFolder:
    """The memory in a folder, of a robot with a small camera."""
    size = {"width": CAMERA.width, "height": CAMERA.height}
    robot = Embodiment()
    robot = robot.model_copy(update={"camera": robot.camera.model_copy(update=size)})
    return MemoryFolder(folder, mapping or MappingConfig(), robot)


def look(home: MemoryFolder, observation: Observation) -> None:
    """Take a frame into the memory, as an agent does."""
    floor = home.memory.follow(observation)
    seen = home.memory.seen_from_ground(observation)
    floor.integrate(seen)
    home.memory.keep_image(seen)


def view(x: float, y: float, yaw: float, z: float = 0.0) -> Observation:
    """What the robot sees of the hall, of which there is one on every floor."""
    return counted_from(-z, view_of(HALL, Pose2(x, y, yaw)))


def searched(folder: Path) -> Path:
    """A folder with the memory of one search on two floors, which stairs connect."""
    with opened(folder) as home:
        memory = home.begin(Goal("bed"), view(1.0, 2.0, 0.0))
        memory.begin_search(lasts=True)
        for z in (0.0, 3.0):
            memory.begin_at(view(1.0, 2.0, 0.0, z))
            for yaw in np.arange(6) * np.pi / 3.0:
                look(home, view(1.0, 2.0, float(yaw), z))
        memory.connectors = STAIRS
        home.end("found", steps=12)
    return folder


def change_index(folder: Path, **values: Any) -> None:
    """Write other values into an index."""
    path = folder / "memory.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | values))


def files_of(folder: Path) -> dict[str, bytes]:
    """The visible files in a folder."""
    return {
        one.relative_to(folder).as_posix(): one.read_bytes()
        for one in sorted(folder.rglob("*"))
        if one.is_file() and not one.name.startswith(".")
    }
