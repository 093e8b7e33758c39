"""Writes a memory: new files first, then the index in one step, then old files go."""

import hashlib
import io
import os
from pathlib import Path

import numpy as np

from hypernav.core.errors import OutputError
from hypernav.core.files.whole_files import write_whole
from hypernav.mapping.memory.floor import Floor
from hypernav.mapping.memory.index import (
    ConnectorRecord,
    FileRecord,
    FloorRecord,
    GoalRecord,
    ImageRecord,
    Index,
    Place,
    SightingRecord,
    ThingRecord,
)
from hypernav.mapping.memory.key_images import KeyImage
from hypernav.mapping.memory.memory import Memory
from hypernav.mapping.ros_map import save_ros_map

INDEX_NAME = "memory.json"
IMAGES = "images"
_SLACK_BYTES = 4000
"""Size of the small files beside maps, index and images."""


class Writer:
    """Writes a memory to its folder again and again; what is there already is not written twice.

    Attributes:
        index: The index that was written or read last; None if there is none.
    """

    def __init__(self, folder: Path, index: Index | None) -> None:
        """Go on from what is in the folder.

        Args:
            folder: The folder, locked.
            index: Its index; None if it is empty.
        """
        self.index: Index | None = index
        self._folder = folder
        self._images = {} if index is None else {one.number: one for one in index.images}
        self._states: dict[int, tuple[object, FileRecord]] = {}

    def write(
        self,
        memory: Memory,
        place: Place | None,
        history: tuple[GoalRecord, ...],
        *,
        most_bytes: int,
    ) -> None:
        """Write the memory.

        Args:
            memory: The memory; key images for which there is no room are forgotten.
            place: Where a simulated building's memory lies.
            history: The searches so far.
            most_bytes: Size of the folder that is allowed, bytes; maps and index are always kept.

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
            )
            grids = [floor.map.grid.cropped() for floor in memory.floors]
            size = sum(one.state.size for one in floors) + sum(grid.cells.size for grid in grids)
            memory.forget_images(max(most_bytes - size - len(_text(index)) - _SLACK_BYTES, 0))
            index = index.model_copy(
                update={
                    "floors": tuple(map(_with_things, floors, memory.floors)),
                    "images": tuple(map(self._image, memory.images.kept if memory.images else ())),
                }
            )
            write_whole(self._folder / INDEX_NAME, _text(index))
            self.index = index
            self._images = {one.number: one for one in index.images}
            for number, grid in enumerate(grids):
                save_ros_map(grid, self._folder / _floor_name(number))
            self._remove_old(index)
        except OSError as error:
            raise OutputError(
                f"the memory {self._folder} cannot be written ({error.strerror or error}); what "
                "was saved before is whole; free some space, or choose another --memory"
            ) from error

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

    def _remove_old(self, index: Index) -> None:
        """Remove images and states that no longer belong to the memory."""
        wanted = {one.state.name for one in index.floors}
        wanted |= {file.name for one in index.images for file in (one.jpeg, one.png)}
        folders = [IMAGES, *(_floor_name(number) for number in range(len(index.floors)))]
        for folder in folders:
            for entry in os.scandir(self._folder / folder):
                is_ours = entry.name.endswith((".jpg", ".png", ".npz", ".new"))
                if is_ours and f"{folder}/{entry.name}" not in wanted:
                    os.unlink(entry.path)


def _text(index: Index) -> str:
    return index.model_dump_json(indent=1) + "\n"


def _floor_name(number: int) -> str:
    return f"floor-{number}"


def _with_things(record: FloorRecord, floor: Floor) -> FloorRecord:
    """The record with the floor's things, which know by now which images were forgotten."""
    things = tuple(map(ThingRecord.of, floor.things.known))
    return record.model_copy(update={"things": things})
