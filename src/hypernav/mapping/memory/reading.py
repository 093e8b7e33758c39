"""Reads a memory: refuses what it can't be sure of, and leaves out damaged parts by name."""

import hashlib
import io
import json
import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydantic import ValidationError

from hypernav.core.embodiment import Embodiment
from hypernav.core.errors import MapError, MemoryFolderError
from hypernav.core.files.allowance import Allowance
from hypernav.core.files.json_text import parse_json
from hypernav.core.files.reading import path_below, read_file
from hypernav.mapping.config import MappingConfig
from hypernav.mapping.memory.floor import Floor
from hypernav.mapping.memory.index import (
    FORMAT,
    VERSION,
    FileRecord,
    FloorRecord,
    GoalRecord,
    ImageRecord,
    Index,
    Place,
)
from hypernav.mapping.memory.key_images import KeyImages, with_patches
from hypernav.mapping.memory.memory import Memory
from hypernav.mapping.memory.writing import INDEX_NAME
from hypernav.mapping.top_down_map import TopDownMap


@dataclass(frozen=True, eq=False)
class Contents:
    """What a folder holds.

    Attributes:
        memory: The memory.
        place: Where a simulated building's memory lies.
        history: The searches so far.
        left_out: One line about each damaged part.
        index: The index; None if the memory is new.
    """

    memory: Memory
    place: Place | None = None
    history: tuple[GoalRecord, ...] = ()
    left_out: tuple[str, ...] = ()
    index: Index | None = None


def read_memory(
    folder: Path, mapping: MappingConfig, embodiment: Embodiment, *, most_bytes: int
) -> Contents | None:
    """What a folder holds; None if there is no memory in it yet.

    Args:
        folder: The folder.
        mapping: Configuration of the maps, which must be the memory's.
        embodiment: The robot, whose body and camera height must be the memory's.
        most_bytes: Size that the key images may have, bytes.

    Raises:
        MemoryFolderError: The index is broken, of another version, or of another robot; or the
            folder holds something else.
    """
    index = read_index(folder)
    if index is None:
        return None
    _check_robot(folder, index, mapping, embodiment)
    images = KeyImages(most_bytes, count=index.image_count)
    memory = Memory(mapping, embodiment, images=images)
    memory.searches = index.searches
    memory.connectors = tuple(one.connector() for one in index.connectors)
    left_out, patches = list[str](), dict[int, np.ndarray]()
    memory.floors = []
    for number, record in enumerate(index.floors):
        floor = _floor_without_map(record, mapping, embodiment)
        try:
            patches |= _restore(floor, folder, record)
        except (OSError, ValueError, KeyError, zipfile.BadZipFile, MapError) as error:
            floor = _floor_without_map(record, mapping, embodiment)
            left_out.append(
                f"the map of floor {number} is damaged ({error}); it is drawn anew, and its things "
                "and images are kept"
            )
        memory.floors.append(floor)
    memory.number = index.floor
    lost = [one.number for one in index.images if not _add_image(images, one, folder, patches)]
    if lost:
        left_out.append(
            f"{len(lost)} of {len(index.images)} key images are damaged and left out: "
            f"{', '.join(map(str, lost[:10]))}{' …' if len(lost) > 10 else ''}"
        )
        for floor in memory.floors:
            floor.things = floor.things.without_images(lost)
    return Contents(memory, index.place, index.history, tuple(left_out), index)


def read_index(folder: Path) -> Index | None:
    """The index of a memory; None if the folder is empty or missing.

    Raises:
        MemoryFolderError: The index is broken or of another version, or the folder holds something
            else.
    """
    path = folder / INDEX_NAME
    try:
        if not path.exists():
            others = [one.name for one in folder.iterdir() if not one.name.startswith(".")]
            if set(others) - {"images", "floor-0"}:
                raise MemoryFolderError(
                    f"{folder} holds other files ({', '.join(sorted(others)[:3])}) and no "
                    f"{INDEX_NAME}; name a folder of its own for a memory"
                )
            return None
        facts = parse_json(read_file(path))
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as error:
        raise MemoryFolderError(_broken(path, str(error))) from error
    kind = facts.get("format") if isinstance(facts, dict) else None
    if kind != FORMAT:
        raise MemoryFolderError(_broken(path, f"its format is {kind!r:.40}, expected {FORMAT!r}"))
    if facts.get("version") != VERSION:
        raise MemoryFolderError(
            f"{path} has version {facts.get('version')!r:.20} of the format, and this program "
            f"reads version {VERSION}; use the program that wrote it, or another folder"
        )
    try:
        index = Index.model_validate_json(json.dumps(facts))
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"]))
        raise MemoryFolderError(_broken(path, f"{where}: {first['msg']}")) from error
    return index


def _broken(path: Path, why: str) -> str:
    return (
        f"{path} is broken ({why:.200}); put back a copy of it, or move {path.parent} away to "
        "begin anew"
    )


def _check_robot(
    folder: Path, index: Index, mapping: MappingConfig, embodiment: Embodiment
) -> None:
    """Refuse maps that another robot, or other cells, would read wrongly."""
    made, now = index.robot, embodiment
    pairs = {
        "mapping": (index.mapping.model_dump(), mapping.model_dump()),
        "embodiment.body": (made.body.model_dump(), now.body.model_dump()),
        "embodiment.camera": (
            {"height_m": made.camera.height_m},
            {"height_m": now.camera.height_m},
        ),
    }
    differences = [
        f"{section}.{key} {before[key]} (now {after[key]})"
        for section, (before, after) in pairs.items()
        for key in before
        if before[key] != after[key]
    ]
    if differences:
        raise MemoryFolderError(
            f"{folder} was made with {', '.join(differences)}; use the same, or another folder"
        )


def _content(folder: Path, record: FileRecord) -> bytes:
    """The content of a file of the memory.

    Raises:
        OSError: It is missing, or can't be read.
        ValueError: It isn't the one that was written.
    """
    content = read_file(path_below(folder, record.name))
    if len(content) != record.size:
        raise ValueError(f"{record.name} has {len(content)} bytes, expected {record.size}")
    if hashlib.sha256(content).hexdigest() != record.sha256:
        raise ValueError(f"{record.name} has another checksum")
    return content


def _floor_without_map(
    record: FloorRecord, mapping: MappingConfig, embodiment: Embodiment
) -> Floor:
    """A floor with what the index knows of it."""
    return Floor(
        record.z,
        TopDownMap(mapping, embodiment),
        things=record.all_things(),
        sightings=record.all_sightings(),
    )


def _restore(floor: Floor, folder: Path, record: FloorRecord) -> dict[int, np.ndarray]:
    """Fill a floor from its file; returns the patches of its key images by number."""
    content = _content(folder, record.state)
    with zipfile.ZipFile(io.BytesIO(content)) as parts:
        Allowance().take(sum(one.file_size for one in parts.infolist()), "a floor")
    with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
        state = {name: arrays[name] for name in arrays.files}
    floor.map.restore(state)
    floor.trajectory = [(x, y) for x, y in state["trajectory"].tolist()]
    ends = np.cumsum(state["patch_counts"])
    pieces = np.split(state["patches"], ends[:-1]) if len(ends) else []
    return dict(zip(state["image_numbers"].tolist(), pieces, strict=True))


def _add_image(
    images: KeyImages, record: ImageRecord, folder: Path, patches: dict[int, np.ndarray]
) -> bool:
    """Add a key image; False if a file of it is damaged."""
    try:
        jpeg, png = _content(folder, record.jpeg), _content(folder, record.png)
    except (OSError, ValueError):
        return False
    known = patches.get(record.number)
    image = record.image(jpeg, png, np.empty(0, np.int64) if known is None else known)
    images.add(image if known is not None else with_patches(image))
    return True
