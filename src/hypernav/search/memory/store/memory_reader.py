"""Reads a memory: refuses what it can't be sure of, and leaves out damaged parts by name."""

import hashlib
from codecs import BOM_UTF8
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from pydantic import ValidationError

from hypernav.core.config import MOST_STEPS
from hypernav.core.embodiment import MOST_PIXELS, Embodiment
from hypernav.core.errors import CameraError, MapError, MemoryFolderError
from hypernav.io.array_files import arrays_in
from hypernav.io.foreign_folder import ForeignFolder, NotOwnError
from hypernav.io.parsing import parse_json
from hypernav.io.reading import JPEG, PNG, Allowance, image_size, read_file
from hypernav.io.reading import MOST_BYTES as MOST_BYTES_READ
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.top_down_map import MapArrays, TopDownMap
from hypernav.search.memory.floor import MOST_POSITIONS, Floor
from hypernav.search.memory.key_images import (
    LARGEST_BYTES,
    MOST_BYTES,
    KeyImage,
    KeyImages,
    with_patches,
)
from hypernav.search.memory.memory import Memory
from hypernav.search.memory.store.memory_index import (
    FORMAT,
    MOST_IMAGES,
    MOST_METRES,
    VERSION,
    FileRecord,
    FloorRecord,
    GoalRecord,
    ImageRecord,
    Index,
    Place,
)
from hypernav.search.memory.store.memory_writer import (
    FLOOR,
    IMAGES,
    INDEX_NAME,
    foreign_files,
    holds_later_save,
)

_MOST_INDEX_BYTES = 100_000_000
_BYTES_PER_PATCH = 120
"""Memory that one patch of surface takes in the count of the images that show it."""
_DEPTH_PNG = b"\x10\x00"
"""Bits and colours in the header of a PNG of 16 bits without colours, after its size."""

_ARRAYS = {
    "trajectory": (np.float64, 2, 16 * (MOST_POSITIONS + MOST_STEPS)),
    "image_numbers": (np.int64, 1, 8 * MOST_IMAGES),
    "patch_counts": (np.int64, 1, 8 * MOST_IMAGES),
    "patches": (np.int64, 1, MOST_BYTES_READ),
}
"""Type, number of dimensions and largest size in bytes of the arrays that aren't the map's."""
_MOST_ARRAY_BYTES = dict.fromkeys(("first", *MapArrays._fields), MOST_BYTES_READ) | {
    name: most for name, (_, _, most) in _ARRAYS.items()
}


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
    home: ForeignFolder,
    mapping: MappingConfig,
    embodiment: Embodiment,
    *,
    most_bytes: int | None = None,
) -> Contents | None:
    """What a folder holds; None if there is no memory in it yet.

    Args:
        home: The folder, which may be a stranger's.
        mapping: Configuration of the maps, which must be the memory's.
        embodiment: The robot, whose body and camera height must be the memory's.
        most_bytes: Size that the folder may have from now on, bytes; None for what it has noted.

    Raises:
        MemoryFolderError: The index is broken, of another version, or of another robot; a file
            can't be read now, damaged or not; all together would take too much memory; or the
            folder holds something else, such as a link.
    """
    allowance = Allowance("a memory")
    index = _index_in(home, allowance)
    if index is None:
        return None
    _check_robot(home.path, index, mapping, embodiment)
    _check_plain(home)
    most = min(most_bytes or index.most_bytes or MOST_BYTES, LARGEST_BYTES)
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
            patches |= _restore(floor, home, record, allowance)
        except (ValueError, MapError) as error:
            floor = _floor_without_map(record, mapping, embodiment)
            damaged.append(record.state.name)
            left_out.append(
                f"the map of floor {number + 1} is damaged ({error}); it is drawn anew, and its "
                "things and images are kept"
            )
        memory.floors.append(floor)
    memory.number = index.floor
    lost = [one for one in index.images if not _add_image(images, one, home, patches, allowance)]
    if lost:
        numbers = [one.number for one in lost]
        damaged += [file.name for one in lost for file in (one.jpeg, one.png)]
        left_out.append(
            f"{len(lost)} of {len(index.images)} key images are missing or damaged, and left out: "
            f"{', '.join(map(str, numbers[:10]))}{' …' if len(lost) > 10 else ''}"
        )
        for floor in memory.floors:
            floor.things = floor.things.without_images(numbers)
    if left_out and not (home.is_in_place() and home.holds(INDEX_NAME)):
        raise MemoryFolderError(
            f"{home.path} was moved or removed while it was read; name the folder where it is now"
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
    try:
        with ForeignFolder(folder) as home:
            index = _index_in(home, Allowance("a memory"))
            _check_plain(home)
            return index
    except FileNotFoundError:
        return None
    except NotADirectoryError as error:
        raise MemoryFolderError(
            f"{folder} is no folder; name the folder of a memory, or a new one"
        ) from error
    except OSError as error:
        raise _unreadable(folder, error) from error


def read_image(folder: Path, record: ImageRecord) -> KeyImage:
    """A key image of a memory, without what it shows of the map.

    Raises:
        ValueError: A file of it is missing or damaged.
        MemoryFolderError: It can't be read now.
    """
    try:
        with ForeignFolder(folder) as home:
            return _image(home, record, Allowance("a memory"), np.empty(0, np.int64))
    except OSError as error:
        raise _unreadable(folder, error) from error


def _check_plain(home: ForeignFolder) -> None:
    """Refuse links, pipes and devices in a memory, before a search that could not be saved.

    Raises:
        MemoryFolderError: It holds one.
    """
    try:
        for name in home.listing():
            if name == IMAGES or FLOOR.fullmatch(name):
                home.listing(name)
    except OSError as error:
        raise _unreadable(home.path, error) from error


def _index_in(home: ForeignFolder, allowance: Allowance) -> Index | None:
    """The index in a folder; None if the folder is empty.

    Raises:
        MemoryFolderError: As `read_index`.
    """
    path = home.path / INDEX_NAME
    try:
        content = home.read(INDEX_NAME, most=_MOST_INDEX_BYTES)
        facts = parse_json(content, allowance)
    except FileNotFoundError:
        _check_empty(home)
        return None
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
        index = Index.model_validate_json(content.removeprefix(BOM_UTF8))
    except ValidationError as error:
        first = error.errors(include_input=False, include_url=False)[0]
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


def _check_empty(home: ForeignFolder) -> None:
    """Refuse a folder in which something lies already."""
    folder = home.path
    try:
        others = foreign_files(home)
        is_later = holds_later_save(home)
        # A first save may have ended since the index was found missing, and a second one, too.
        if home.holds(INDEX_NAME):
            return
    except OSError as error:
        raise _unreadable(folder, error) from error
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
    if isinstance(error, NotOwnError):
        return MemoryFolderError(
            f"{path} can't be trusted: {error.strerror}; remove that entry, or use a copy of the "
            "memory without links, pipes and devices"
        )
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


def _content(home: ForeignFolder, record: FileRecord, allowance: Allowance) -> bytes:
    """The content of a file of the memory.

    Raises:
        ValueError: It is missing, or isn't the one that was written.
        MemoryFolderError: It can't be read now.
    """
    _spend(home, allowance, record.size, record.name)
    try:
        content = home.read(record.name)
    except FileNotFoundError:
        raise ValueError(f"{record.name} is missing") from None
    except OSError as error:
        raise _unreadable(home.path / record.name, error) from error
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


def _spend(home: ForeignFolder, allowance: Allowance, size: int, what: str) -> None:
    """Account for memory.

    Raises:
        MemoryFolderError: The whole memory takes too much.
    """
    try:
        allowance.spend(size, what)
    except OSError as error:
        raise MemoryFolderError(
            f"{home.path} can't be opened: {error.strerror}; name another folder"
        ) from error


def _restore(
    floor: Floor, home: ForeignFolder, record: FloorRecord, allowance: Allowance
) -> dict[int, np.ndarray]:
    """Fill a floor from its file; returns the patches of its key images by number."""
    content = _content(home, record.state, allowance)
    state = arrays_in(content, _MOST_ARRAY_BYTES, partial(_spend, home, allowance))
    for name, (kind, dimensions, _) in _ARRAYS.items():
        array = state.get(name)
        if array is None:
            raise ValueError(f"{name} is missing")
        if array.dtype != kind or array.ndim != dimensions:
            raise ValueError(f"{name} has the type {array.dtype} and the shape {array.shape}")
    trajectory, counts = state["trajectory"], state["patch_counts"]
    if trajectory.shape[1] != 2 or not (np.abs(trajectory) <= MOST_METRES).all():
        raise ValueError("the trajectory leads nowhere")
    if (counts < 0).any() or counts.sum() != len(state["patches"]):
        raise ValueError("the patches are not as many as counted")
    pieces = np.split(state["patches"], np.cumsum(counts)[:-1]) if len(counts) else []
    patches = dict(zip(state["image_numbers"].tolist(), pieces, strict=True))
    floor.map.restore(state)
    floor.trajectory = [(x, y) for x, y in trajectory[-MOST_POSITIONS:].tolist()]
    floor.was_explored = record.was_explored
    return patches


def _add_image(
    images: KeyImages,
    record: ImageRecord,
    home: ForeignFolder,
    patches: dict[int, np.ndarray],
    allowance: Allowance,
) -> bool:
    """Add a key image; False if a file of it is damaged."""
    known, shown = patches.get(record.number), len(images.showing)
    try:
        image = _image(home, record, allowance, np.empty(0, np.int64) if known is None else known)
        images.add(image if known is not None else with_patches(image))
    except (ValueError, CameraError):
        return False
    _spend(home, allowance, _BYTES_PER_PATCH * (len(images.showing) - shown), "what images show")
    return True


def _image(
    home: ForeignFolder, record: ImageRecord, allowance: Allowance, patches: np.ndarray
) -> KeyImage:
    """A key image from its two files.

    Raises:
        ValueError: One is missing, damaged, or of another size than its camera's.
        MemoryFolderError: One can't be read now.
    """
    jpeg, png = (_content(home, one, allowance) for one in (record.jpeg, record.png))
    _check_sizes(record, jpeg, png)
    return record.image(jpeg, png, patches)


def _check_sizes(record: ImageRecord, jpeg: bytes, png: bytes) -> None:
    """Refuse images of other sizes than the camera's, by their headers.

    Raises:
        ValueError: One is larger, or in another format.
    """
    width, height = record.camera[:2]
    is_depth = png.startswith(PNG) and png[24:26] == _DEPTH_PNG
    depth = image_size(png) if is_depth else None
    if (
        width * height > MOST_PIXELS
        or not jpeg.startswith(JPEG)
        or image_size(jpeg) != (width, height)
        or depth is None
        or not (0 < depth[0] <= width and 0 < depth[1] <= height)
    ):
        raise ValueError("it is no image, or has another size than its camera")
