"""Writes a memory: new files first, then the index in one step, then old files go."""

import errno
import hashlib
import io
import re
from fnmatch import fnmatch

import numpy as np

from hypernav.core.errors import OutputError
from hypernav.core.naming.words import megabytes
from hypernav.io.foreign_folder import ForeignFolder
from hypernav.io.writing import lacks_room
from hypernav.search.mapping.ros_map import ros_map_files
from hypernav.search.memory.floor import Floor
from hypernav.search.memory.key_images import KeyImage
from hypernav.search.memory.memory import Memory
from hypernav.search.memory.store.memory_index import (
    OURS,
    ConnectorRecord,
    FileRecord,
    FloorRecord,
    GoalRecord,
    ImageRecord,
    Index,
    Place,
    SightingRecord,
    ThingRecord,
    UnderWayRecord,
)

INDEX_NAME = "memory.json"
IMAGES = "images"
FLOOR = re.compile(r"floor-[0-9]{1,4}")
_OURS = re.compile(OURS)
"""No other file is ever removed from the folder."""
_UNFINISHED = re.compile(r"(images|floor-\d+)/\..+\.new")
_FOR_OTHERS = re.compile(r"floor-\d+/map\.(yaml|pgm)")
_DAMAGED = ".damaged"
_SLACK_BYTES = 4000
"""Size of the small files beside maps, index and images."""
_MOST_MAPS_BYTES = 1_200_000_000
"""Memory that all maps may take, bytes, so that the memory can be opened again."""


class Writer:
    """Writes a memory to its folder again and again; what is there already is not written twice.

    Attributes:
        index: The index that was written or read last; None if there is none.
        keeps_damaged_images: Whether damaged key images stay in the folder.
    """

    def __init__(
        self, home: ForeignFolder, index: Index | None, *, damaged: tuple[str, ...] = ()
    ) -> None:
        """Go on from what is in the folder.

        Args:
            home: The folder, locked.
            index: Its index; None if it is empty.
            damaged: Names of files that were left out; they get other names, and are kept.
        """
        self.index: Index | None = index
        self.keeps_damaged_images: bool = True
        self._home = home
        self._damaged = damaged
        self._images = {} if index is None else {one.number: one for one in index.images}
        self._states: dict[int, tuple[object, FileRecord]] = {}

    def write(
        self,
        memory: Memory,
        place: Place | None,
        history: tuple[GoalRecord, ...],
        *,
        most_bytes: int | None,
    ) -> None:
        """Write the memory.

        Args:
            memory: The memory; key images for which there is no room are forgotten.
            place: Where a simulated building's memory lies.
            history: The searches so far.
            most_bytes: Size that the folder may have, bytes; maps and index are always kept. None
                keeps all images, too, and the size that earlier saves have noted.

        Raises:
            OutputError: The disk is full, the folder can't be written, or the maps are too large.
        """
        _check_maps(memory)
        saves = 1 if self.index is None else self.index.saves + 1
        try:
            if not self._home.is_in_place():
                raise FileNotFoundError(errno.ENOENT, "it was moved")
            self._home.make_folder(IMAGES)
            floors = [
                self._floor(number, floor, memory, saves)
                for number, floor in enumerate(memory.floors)
            ]
            index = Index(
                saves=saves,
                robot=memory.embodiment,
                mapping=memory.mapping,
                place=place,
                searches=memory.searches,
                floor=memory.number,
                floors=tuple(floors),
                images=(),
                image_count=memory.images.count if memory.images else 0,
                history=history,
                connectors=tuple(map(ConnectorRecord.of, memory.connectors)),
                under_way=UnderWayRecord.of(memory.under_way),
                most_bytes=self._noted_bytes if most_bytes is None else most_bytes,
            )
            grids = [floor.map.grid.cropped() for floor in memory.floors]
            size = sum(one.state.size for one in floors) + sum(grid.cells.size for grid in grids)
            if most_bytes is not None:
                memory.make_room(max(most_bytes - size - len(_text(index)) - _SLACK_BYTES, 0))
            index = index.model_copy(
                update={
                    "floors": tuple(map(_with_things, floors, memory.floors)),
                    "images": tuple(map(self._image, memory.images.kept if memory.images else ())),
                }
            )
            self._set_damaged_aside()
            self._home.write(INDEX_NAME, _text(index))
            self.index = index
            self._images = {one.number: one for one in index.images}
            for number, grid in enumerate(grids):
                for name, content in ros_map_files(grid).items():
                    self._home.write(f"{_floor_name(number)}/{name}", content)
            self._remove_old(index)
        except OSError as error:
            raise self._unwritten(error) from error

    def _unwritten(self, error: OSError) -> OutputError:
        """The error for a memory that can't be written, with what helps."""
        if not self._home.is_in_place():
            return OutputError(
                f"the memory {self._home.path} was moved or removed while it was in use; what was "
                "saved before is whole where it is now, and the rest is lost"
            )
        remedy = lacks_room(error) or "make that possible"
        return OutputError(
            f"the memory {self._home.path} cannot be written ({error.strerror or error}); what was "
            f"saved before is whole; {remedy}, or choose another --memory"
        )

    @property
    def _noted_bytes(self) -> int | None:
        return None if self.index is None else self.index.most_bytes

    def _floor(self, number: int, floor: Floor, memory: Memory, saves: int) -> FloorRecord:
        """The record of a floor, whose state is written if it has changed."""
        images = [one for one in memory.images.kept if one.floor == number] if memory.images else []
        fingerprint = (memory.searches, len(floor.trajectory), [one.number for one in images])
        known = self._states.get(number)
        if known is None or known[0] != fingerprint:
            self._home.make_folder(_floor_name(number))
            data = io.BytesIO()
            np.savez_compressed(
                data,
                allow_pickle=False,
                trajectory=np.array(floor.trajectory, dtype=np.float64).reshape(-1, 2),
                image_numbers=np.array([one.number for one in images], dtype=np.int64),
                patch_counts=np.array([len(one.patches) for one in images], dtype=np.int64),
                patches=np.concatenate([np.empty(0, np.int64), *(one.patches for one in images)]),
                **floor.map.state,
            )
            name = f"{_floor_name(number)}/state-{saves}.npz"
            known = (fingerprint, self._file(name, data.getvalue()))
            self._states[number] = known
        return FloorRecord(
            z=floor.z,
            state=known[1],
            things=tuple(map(ThingRecord.of, floor.things.known)),
            thing_count=floor.things.count,
            sightings=tuple(
                SightingRecord(label=one.label, position=one.position)
                for one in floor.sightings.things
            ),
            named=tuple(sorted(floor.sightings.named)),
            was_explored=floor.was_explored,
        )

    def _image(self, image: KeyImage) -> ImageRecord:
        """The record of a key image, whose files are written once."""
        known = self._images.get(image.number)
        if known is not None:
            return known
        stem = f"{IMAGES}/{image.number:06}"
        return ImageRecord.of(
            image, self._file(f"{stem}.jpg", image.jpeg), self._file(f"{stem}.png", image.png)
        )

    def _file(self, name: str, content: bytes) -> FileRecord:
        self._home.write(name, content)
        digest = hashlib.sha256(content).hexdigest()
        return FileRecord(name=name, size=len(content), sha256=digest)

    def _set_damaged_aside(self) -> None:
        """Rename damaged files: a person may still rescue what is in them."""
        for name in self._damaged:
            if self._home.holds(name):
                self._home.rename(name, f"{name.partition('/')[2]}{_DAMAGED}")
        self._damaged = ()

    def _remove_old(self, index: Index) -> None:
        """Remove images and states that no longer belong to the memory."""
        wanted = {one.state.name for one in index.floors}
        wanted |= {file.name for one in index.images for file in (one.jpeg, one.png)}
        for folder in (IMAGES, *(_floor_name(number) for number in range(len(index.floors)))):
            for entry, is_folder in self._home.listing(folder).items():
                name = f"{folder}/{entry}"
                is_old = _OURS.fullmatch(name) and name not in wanted
                is_forgotten = (
                    not self.keeps_damaged_images
                    and folder == IMAGES
                    and _OURS.fullmatch(name.removesuffix(_DAMAGED))
                )
                if is_folder:
                    continue
                if is_old or is_forgotten or _UNFINISHED.fullmatch(name):
                    self._home.remove(name)


def _check_maps(memory: Memory) -> None:
    """Refuse maps that the memory could not be opened with again.

    Raises:
        OutputError: They are too large.
    """
    size = sum(array.nbytes for floor in memory.floors for array in floor.map.state.values())
    if size > _MOST_MAPS_BYTES:
        raise OutputError(
            f"the maps of the memory take {megabytes(size)}, at most {megabytes(_MOST_MAPS_BYTES)} "
            "are saved; use a larger mapping.cell_size_m, or a memory for each part of the building"
        )


def foreign_files(home: ForeignFolder) -> list[str]:
    """What is in a folder without index and isn't left behind by a first save that was killed.

    Raises:
        OSError: The folder can't be read, or holds links, pipes or devices.
    """
    entries = home.listing()
    names = [name for name in entries if not name.startswith(".")]
    folders = [
        name
        for name, is_folder in entries.items()
        if is_folder and (name == IMAGES or FLOOR.fullmatch(name))
    ]
    within = [f"{folder}/{name}" for folder in folders for name in home.listing(folder)]
    kinds = (_OURS, _UNFINISHED, _FOR_OTHERS)
    foreign = [name for name in within if not any(kind.fullmatch(name) for kind in kinds)]
    # Floors are written before images: without one, the images are somebody's own.
    if f"{_floor_name(0)}/state-1.npz" not in within:
        foreign += [name for name in within if name.startswith(f"{IMAGES}/")]
    return [*(name for name in names if name not in folders), *foreign]


def holds_later_save(home: ForeignFolder) -> bool:
    """Whether a folder without index had one: a first save that was killed leaves other names.

    Raises:
        OSError: The folder can't be read.
    """
    folders = [name for name, is_folder in home.listing().items() if is_folder]
    names = [name for folder in folders if FLOOR.fullmatch(folder) for name in home.listing(folder)]
    states = [name for name in names if fnmatch(name, "state-*.npz")]
    return bool(states) and "state-1.npz" not in states


def _text(index: Index) -> str:
    return index.model_dump_json(indent=1) + "\n"


def _floor_name(number: int) -> str:
    return f"floor-{number + 1}"  # people count floors from 1


def _with_things(record: FloorRecord, floor: Floor) -> FloorRecord:
    """The record with the floor's things, which know by now which images were forgotten."""
    things = tuple(map(ThingRecord.of, floor.things.known))
    return record.model_copy(update={"things": things})
