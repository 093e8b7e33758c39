"""Writes a memory: new files first, then the index in one step, then old files go."""

import hashlib
import io
import os
import re
from pathlib import Path

import numpy as np

from hypernav.core.errors import OutputError
from hypernav.io.writing import lacks_room, write_whole
from hypernav.search.mapping.memory.floor import Floor
from hypernav.search.mapping.memory.key_images import KeyImage
from hypernav.search.mapping.memory.memory import Memory
from hypernav.search.mapping.ros_map import save_ros_map
from hypernav.search.mapping.storage.memory_index import (
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
_FLOOR = re.compile(r"floor-\d+")
_OURS = re.compile(r"(images/\d{6,}\.(jpg|png)|floor-\d+/state-\d+\.npz)")
"""Files of a memory besides its index; no other is ever removed from its folder."""
_UNFINISHED = re.compile(r"(images|floor-\d+)/\..+\.new")
_FOR_OTHERS = re.compile(r"floor-\d+/map\.(yaml|pgm)")
_DAMAGED = ".damaged"
_SLACK_BYTES = 4000
"""Size of the small files beside maps, index and images."""


class Writer:
    """Writes a memory to its folder again and again; what is there already is not written twice.

    Attributes:
        index: The index that was written or read last; None if there is none.
        keeps_damaged_images: Whether damaged key images stay in the folder.
    """

    def __init__(self, folder: Path, index: Index | None, *, damaged: tuple[str, ...] = ()) -> None:
        """Go on from what is in the folder.

        Args:
            folder: The folder, locked.
            index: Its index; None if it is empty.
            damaged: Names of files that were left out; they get other names, and are kept.
        """
        self.index: Index | None = index
        self.keeps_damaged_images: bool = True
        self._folder = folder
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
            OutputError: The disk is full, or the folder can't be written.
        """
        saves = 1 if self.index is None else self.index.saves + 1
        try:
            (self._folder / IMAGES).mkdir(exist_ok=True)
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
            write_whole(self._folder / INDEX_NAME, _text(index))
            self.index = index
            self._images = {one.number: one for one in index.images}
            for number, grid in enumerate(grids):
                save_ros_map(grid, self._folder / _floor_name(number))
            self._remove_old(index)
        except OSError as error:
            raise self._unwritten(error) from error

    def _unwritten(self, error: OSError) -> OutputError:
        """The error for a memory that can't be written, with what helps."""
        if not self._folder.is_dir():
            return OutputError(
                f"the memory {self._folder} was moved or removed while it was in use; what was "
                "saved before is whole where it is now, and the rest is lost"
            )
        remedy = lacks_room(error) or "make that possible"
        return OutputError(
            f"the memory {self._folder} cannot be written ({error.strerror or error}); what was "
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
            (self._folder / _floor_name(number)).mkdir(exist_ok=True)
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
        write_whole(self._folder / name, content)
        digest = hashlib.sha256(content).hexdigest()
        return FileRecord(name=name, size=len(content), sha256=digest)

    def _set_damaged_aside(self) -> None:
        """Rename damaged files: a person may still rescue what is in them."""
        for name in self._damaged:
            path = self._folder / name
            if _OURS.fullmatch(name) and path.exists():
                path.replace(f"{path}{_DAMAGED}")
        self._damaged = ()

    def _remove_old(self, index: Index) -> None:
        """Remove images and states that no longer belong to the memory."""
        wanted = {one.state.name for one in index.floors}
        wanted |= {file.name for one in index.images for file in (one.jpeg, one.png)}
        for folder in (IMAGES, *(_floor_name(number) for number in range(len(index.floors)))):
            for entry in os.scandir(self._folder / folder):
                name = f"{folder}/{entry.name}"
                is_old = _OURS.fullmatch(name) and name not in wanted
                is_forgotten = (
                    not self.keeps_damaged_images
                    and folder == IMAGES
                    and _OURS.fullmatch(name.removesuffix(_DAMAGED))
                )
                if entry.is_dir(follow_symlinks=False):
                    continue
                if is_old or is_forgotten or _UNFINISHED.fullmatch(name):
                    os.unlink(entry.path)


def foreign_files(folder: Path) -> list[str]:
    """What is in a folder without index and isn't left behind by a first save that was killed.

    Raises:
        OSError: The folder can't be read.
    """
    entries = list(os.scandir(folder)) if folder.exists() else []
    names = [one.name for one in entries if not one.name.startswith(".")]
    folders = [
        one.name
        for one in entries
        if one.is_dir() and (one.name == IMAGES or _FLOOR.fullmatch(one.name))
    ]
    within = [f"{one}/{entry.name}" for one in folders for entry in os.scandir(folder / one)]
    kinds = (_OURS, _UNFINISHED, _FOR_OTHERS)
    foreign = [name for name in within if not any(kind.fullmatch(name) for kind in kinds)]
    # Floors are written before images: without one, the images are somebody's own.
    if not (folder / _floor_name(0) / "state-1.npz").exists():
        foreign += [name for name in within if name.startswith(f"{IMAGES}/")]
    return [*(name for name in names if name not in folders), *foreign]


def holds_later_save(folder: Path) -> bool:
    """Whether a folder without index had one: a first save that was killed leaves other names.

    Raises:
        OSError: The folder can't be read.
    """
    states = [path.name for path in folder.glob("floor-*/state-*.npz")]
    return bool(states) and "state-1.npz" not in states


def _text(index: Index) -> str:
    return index.model_dump_json(indent=1) + "\n"


def _floor_name(number: int) -> str:
    return f"floor-{number + 1}"  # people count floors from 1


def _with_things(record: FloorRecord, floor: Floor) -> FloorRecord:
    """The record with the floor's things, which know by now which images were forgotten."""
    things = tuple(map(ThingRecord.of, floor.things.known))
    return record.model_copy(update={"things": things})
