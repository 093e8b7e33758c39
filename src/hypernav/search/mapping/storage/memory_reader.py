"""Reads a memory: refuses what it can't be sure of, and leaves out damaged parts by name."""

import hashlib
import io
import json
import zipfile
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydantic import ValidationError

from hypernav.core.embodiment import Embodiment
from hypernav.core.errors import CameraError, MapError, MemoryFolderError
from hypernav.io.parsing import parse_json
from hypernav.io.reading import Allowance, path_below, read_file
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.memory.floor import Floor
from hypernav.search.mapping.memory.key_images import MOST_BYTES, KeyImages, with_patches
from hypernav.search.mapping.memory.memory import Memory
from hypernav.search.mapping.storage.memory_index import (
    FORMAT,
    VERSION,
    FileRecord,
    FloorRecord,
    GoalRecord,
    ImageRecord,
    Index,
    Place,
)
from hypernav.search.mapping.storage.memory_writer import (
    INDEX_NAME,
    foreign_files,
    holds_later_save,
)
from hypernav.search.mapping.top_down_map import TopDownMap

_UNDECODABLE = (
    *(ValueError, KeyError, EOFError, RuntimeError, MapError),
    *(zipfile.BadZipFile, zlib.error),
)
"""What zipfile, numpy and the map raise for content that isn't what was written."""


_ARRAYS = (
    ("trajectory", np.float64, 2),
    ("image_numbers", np.int64, 1),
    ("patch_counts", np.int64, 1),
    ("patches", np.int64, 1),
)
"""Name, type and number of dimensions of the arrays that aren't the map's."""


@dataclass(frozen=True, eq=False)
class Contents:
    """What a folder holds.

    Attributes:
        memory: The memory.
        place: Where a simulated building's memory lies.
        history: The searches so far.
        left_out: One line about each damaged part.
        damaged: Names of the files of these parts.
        index: The index; None if the memory is new.
        most_bytes: Size that the folder may have, bytes.
    """

    memory: Memory
    place: Place | None = None
    history: tuple[GoalRecord, ...] = ()
    left_out: tuple[str, ...] = ()
    damaged: tuple[str, ...] = ()
    index: Index | None = None
    most_bytes: int = MOST_BYTES


def read_memory(
    folder: Path,
    mapping: MappingConfig,
    embodiment: Embodiment,
    *,
    most_bytes: int | None = None,
) -> Contents | None:
    """What a folder holds; None if there is no memory in it yet.

    Args:
        folder: The folder.
        mapping: Configuration of the maps, which must be the memory's.
        embodiment: The robot, whose body and camera height must be the memory's.
        most_bytes: Size that the folder may have from now on, bytes; None for what it has noted.

    Raises:
        MemoryFolderError: The index is broken, of another version, or of another robot; a file
            can't be read now, damaged or not; or the folder holds something else.
    """
    index = read_index(folder)
    if index is None:
        return None
    _check_robot(folder, index, mapping, embodiment)
    most = most_bytes or index.most_bytes or MOST_BYTES
    images = KeyImages(most, count=index.image_count)
    memory = Memory(mapping, embodiment, images=images)
    memory.searches = index.searches
    memory.connectors = tuple(one.connector() for one in index.connectors)
    if (last := index.under_way) is not None:
        memory.under_way = last.under_way()
    left_out, damaged, patches = list[str](), list[str](), dict[int, np.ndarray]()
    memory.floors = []
    for number, record in enumerate(index.floors):
        floor = _floor_without_map(record, mapping, embodiment)
        try:
            patches |= _restore(floor, folder, record)
        except _UNDECODABLE as error:
            floor = _floor_without_map(record, mapping, embodiment)
            damaged.append(record.state.name)
            left_out.append(
                f"the map of floor {number + 1} is damaged ({error}); it is drawn anew, and its "
                "things and images are kept"
            )
        memory.floors.append(floor)
    memory.number = index.floor
    lost = [one for one in index.images if not _add_image(images, one, folder, patches)]
    if lost:
        numbers = [one.number for one in lost]
        damaged += [file.name for one in lost for file in (one.jpeg, one.png)]
        left_out.append(
            f"{len(lost)} of {len(index.images)} key images are missing or damaged, and left out: "
            f"{', '.join(map(str, numbers[:10]))}{' …' if len(lost) > 10 else ''}"
        )
        for floor in memory.floors:
            floor.things = floor.things.without_images(numbers)
    if left_out and not (folder / INDEX_NAME).exists():
        raise MemoryFolderError(
            f"{folder} was moved or removed while it was read; name the folder where it is now"
        )
    return Contents(
        memory, index.place, index.history, tuple(left_out), tuple(damaged), index, most
    )


def check_usable(folder: Path, mapping: MappingConfig, embodiment: Embodiment) -> None:
    """Refuse a folder that `read_memory` would refuse by its index, without changing anything.

    That may be done without a lock: an index is replaced in one step, and what a first save has
    written before it is no foreign file.

    Args:
        folder: The folder.
        mapping: Configuration of the maps, which must be the memory's.
        embodiment: The robot, whose body and camera height must be the memory's.

    Raises:
        MemoryFolderError: As `read_memory`.
    """
    index = read_index(folder)
    if index is not None:
        _check_robot(folder, index, mapping, embodiment)


def read_index(folder: Path) -> Index | None:
    """The index of a memory; None if the folder is empty or missing.

    Raises:
        MemoryFolderError: The index is broken or of another version, or can't be read now, or the
            folder holds something else.
    """
    path = folder / INDEX_NAME
    try:
        facts = parse_json(read_file(path))
    except FileNotFoundError:
        _check_empty(folder)
        return None
    except NotADirectoryError as error:
        raise MemoryFolderError(
            f"{folder} is no folder; name the folder of a memory, or a new one"
        ) from error
    except OSError as error:
        raise _unreadable(path, error) from error
    except ValueError as error:
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
        where = "".join(f"{part}." for part in first["loc"]).removesuffix(".")
        words = first["msg"].removeprefix("Value error, ")
        raise MemoryFolderError(_broken(path, f"{where}: {words}" if where else words)) from error
    return index


def check_not_inside_another(folder: Path) -> None:
    """Refuse to begin a memory in a folder inside that of another one.

    Raises:
        MemoryFolderError: There is no memory in it yet, and one in a folder around it.
    """
    if (folder / INDEX_NAME).exists():
        return
    for outer in folder.resolve().parents:
        try:
            facts = parse_json(read_file(outer / INDEX_NAME))
        except (OSError, ValueError):  # no memory, or none that can be told from other files
            continue
        if isinstance(facts, dict) and facts.get("format") == FORMAT:
            raise MemoryFolderError(
                f"{folder} lies in {outer}, which is a memory itself; name that one, or a folder "
                "elsewhere"
            )


def _check_empty(folder: Path) -> None:
    """Refuse a folder in which something lies already."""
    try:
        others = foreign_files(folder)
        is_later = holds_later_save(folder)
    except OSError as error:
        raise _unreadable(folder, error) from error
    # A first save may have ended since the index was found missing, and a second one, too.
    if (folder / INDEX_NAME).exists():
        return
    if is_later:
        raise MemoryFolderError(
            f"{folder} looks like a memory that lost its {INDEX_NAME}, without which it can't be "
            f"read; put back a copy of that file, or move {folder} away to begin anew"
        )
    if others:
        raise MemoryFolderError(
            f"{folder} holds other files ({', '.join(sorted(others)[:3])}) and no {INDEX_NAME}; "
            "name a folder of its own for a memory"
        )


def _broken(path: Path, why: str) -> str:
    return (
        f"{path} is broken ({why:.200}); put back a copy of it, or move {path.parent} away to "
        "begin anew"
    )


def _unreadable(path: Path, error: OSError) -> MemoryFolderError:
    return MemoryFolderError(
        f"{path} cannot be read ({error.strerror or error}); it may be whole, and nothing is "
        "changed: see to it that it can be read, and try again"
    )


def _check_robot(
    folder: Path, index: Index, mapping: MappingConfig, embodiment: Embodiment
) -> None:
    """Refuse maps that another robot, or other cells, would read wrongly.

    ``sees_drops`` may differ: a drop on the map is forgotten where its floor is seen.
    """
    made, now = index.robot, embodiment
    pairs = {
        "mapping": (
            index.mapping.model_dump(exclude={"sees_drops"}),
            mapping.model_dump(exclude={"sees_drops"}),
        ),
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


def checked_content(folder: Path, record: FileRecord) -> bytes:
    """The content of a file of the memory.

    Raises:
        ValueError: It is missing, or isn't the one that was written.
        MemoryFolderError: It can't be read now.
    """
    try:
        path = path_below(folder, record.name)
    except OSError as error:
        raise ValueError(f"{record.name}: {error.strerror}") from error
    try:
        content = read_file(path)
    except FileNotFoundError:
        raise ValueError(f"{record.name} is missing") from None
    except OSError as error:
        raise _unreadable(path, error) from error
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
    content = checked_content(folder, record.state)
    with zipfile.ZipFile(io.BytesIO(content)) as parts:
        Allowance().spend(sum(one.file_size for one in parts.infolist()), "a floor")
    with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
        state = {name: arrays[name] for name in arrays.files}
    for name, kind, dimensions in _ARRAYS:
        array = state[name]
        if array.dtype != kind or array.ndim != dimensions:
            raise ValueError(f"{name} has the type {array.dtype} and the shape {array.shape}")
    trajectory, counts = state["trajectory"], state["patch_counts"]
    if not np.isfinite(trajectory).all() or counts.sum() != len(state["patches"]):
        raise ValueError("the trajectory isn't finite, or the patches are not as many as counted")
    pieces = np.split(state["patches"], np.cumsum(counts)[:-1]) if len(counts) else []
    patches = dict(zip(state["image_numbers"].tolist(), pieces, strict=True))
    floor.map.restore(state)
    floor.trajectory = [(x, y) for x, y in trajectory.tolist()]
    floor.was_explored = record.was_explored
    return patches


def _add_image(
    images: KeyImages, record: ImageRecord, folder: Path, patches: dict[int, np.ndarray]
) -> bool:
    """Add a key image; False if a file of it is damaged."""
    known = patches.get(record.number)
    try:
        jpeg, png = checked_content(folder, record.jpeg), checked_content(folder, record.png)
        image = record.image(jpeg, png, np.empty(0, np.int64) if known is None else known)
        images.add(image if known is not None else with_patches(image))
    except (ValueError, CameraError):
        return False
    return True
