"""The journal of one search: all that is needed to continue it after a restart.

A search is a function of its observations and of the model's answers. So both are written to disk
as they come, each observation before it is processed, each decision before it is sent to the robot.
A restarted server gives the same observations to a new agent, with the recorded answers. So an
agent's memory needs no file format, and no question is paid for twice.

The folder of a search holds:

- ``search.json``: the request, and the configuration of the agent.
- ``observations.bin``: the observations as they were received (`RecordFile`).
- ``steps.bin``: one `StepRecord` as JSON for every decision.
- ``model.jsonl``: the exchanges with the model (`hypernav.search.models.chat.recording`).
- ``no_entry.json``: the places that people closed to the robot, if there are any.
- ``go_to.json``: the places that they sent it to, likewise.
- ``end.json``: how the search ended, with ``map.pgm`` and ``map.yaml`` of the floor where it did,
  and those of other floors in ``floor_N``. Until then a hidden file
  reserves its disk space, so that a stop can be written on a full disk, too.
"""

import json
import os
import re
import struct
import threading
import zlib
from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.errors import HyPerNavError, RunFolderError
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.trace import StepTrace
from hypernav.io.foreign_folder import read_own
from hypernav.io.writing import AppendOnlyFile, own_descriptor
from hypernav.robot.server.searches.spans import ClosedSpans, SentSpans
from hypernav.robot.wire.frames import unpack_observation
from hypernav.robot.wire.replies import Reply, SearchEnding, StartInMemory
from hypernav.robot.wire.requests import OpenSearch
from hypernav.robot.wire.values import Message, SearchId
from hypernav.search.mapping.ros_map import load_ros_map, save_ros_map

_HEADER = struct.Struct("<II")


class RecordFile:
    """An append-only file of records. A last record left incomplete by a crash is cut off.

    Not thread-safe.
    """

    def __init__(self, path: Path, *, to_read: bool = False) -> None:
        """Open or create the file, and continue after its last complete record.

        Args:
            path: Path of the file.
            to_read: Whether to open it for reading only, since somebody else may be writing it.

        Raises:
            RunFolderError: It cannot be opened.
        """
        self.path = path
        try:
            self._file = AppendOnlyFile(path, mode=0o600, to_read=to_read)
            self._offsets = list(_whole_records(self._file))
            end = self._offsets.pop()
            if not to_read:
                self._file.cut(end)
        except OSError as error:
            raise _unwritable(path, error) from error

    def __len__(self) -> int:
        """Number of records."""
        return len(self._offsets)

    def append(self, record: bytes, *, sync: bool) -> None:
        """Write a record, completely or not at all.

        Args:
            record: Its bytes; an empty record at the end of the file does not last.
            sync: Whether to wait until it, and all before it, are on the disk. Without that they
                survive a crash of this program, but not a loss of power.

        Raises:
            RunFolderError: The disk is full, or the file cannot be written. It is unchanged.
        """
        at, data = self._file.size, _HEADER.pack(len(record), zlib.crc32(record)) + record
        try:
            self._file.append(data, sync=sync)
        except OSError as error:
            raise _unwritable(self.path, error) from error
        self._offsets.append(at)

    def sync(self) -> None:
        """Wait until all records are on the disk.

        Raises:
            RunFolderError: The disk fails.
        """
        try:
            self._file.sync()
        except OSError as error:
            raise _unwritable(self.path, error) from error

    def read(self, number: int) -> bytes:
        """A record by its number, from 0.

        Raises:
            RunFolderError: The file was damaged.
        """
        at = self._offsets[number]
        length, checksum = _HEADER.unpack(self._file.read(at, _HEADER.size))
        record = self._file.read(at + _HEADER.size, length)
        if len(record) != length or zlib.crc32(record) != checksum:
            raise RunFolderError(f"{self.path}: record {number} was damaged since it was written")
        return record

    def cut(self, count: int) -> None:
        """Keep the first records only."""
        if count < len(self._offsets):
            self._file.cut(self._offsets[count])
            del self._offsets[count:]

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def _whole_records(file: AppendOnlyFile) -> Iterator[int]:
    """Offsets of the records, and the end of the last complete one."""
    at = 0
    while True:
        yield at
        header = file.read(at, _HEADER.size)
        if len(header) < _HEADER.size:
            return
        length, checksum = _HEADER.unpack(header)
        end = at + _HEADER.size + length
        if end > file.size:
            return
        if length == 0 and not any(file.read(at, file.size - at)):
            return  # zeros to the end are what a loss of power leaves
        if end == file.size and zlib.crc32(file.read(at + _HEADER.size, length)) != checksum:
            return
        at = end


def _unwritable(path: Path, error: OSError) -> RunFolderError:
    return RunFolderError(
        f"{path} cannot be written ({error.strerror or error}); all answers up to now are "
        "saved. Free some space and go on"
    )


MODEL_FILE = "model.jsonl"
_MAP_FILE = "map.yaml"
_END_FILE = "end.json"
_PAUSED_FILE = "paused"
_NO_ENTRY_FILE = "no_entry.json"
_GO_TO_FILE = "go_to.json"
_FLOOR = "floor_"
_MOST_BYTES = 20_000_000
_ROOM_FOR_END = 4096

_Model = TypeVar("_Model", bound=BaseModel)


class SearchRecord(Message):
    """What a search was opened with.

    Attributes:
        id: Name of the search.
        opened_s: Time of opening, seconds since 1970.
        version: Version of hypernav that opened it.
        words: Detector and reasoner, described for people.
        request: The robot's request.
        specs: Specifications of the agent's components.
        config: Configuration of the agent.
        memory: Folder of the memory that it adds to; None if there is none.
        memory_mb: Size that the memory may have from now on, megabytes; None for its own.
        relocalize: Whether the robot turns around at the start, to find out where it is in that
            memory: it doesn't know, and the memory is not a new one.
        memory_save: Name of the save that the search began with; a restarted server goes on with no
            other. None without a memory, and where an older server opened the search.
        earlier_searches: Number of searches that the memory knew before; None likewise.
    """

    id: SearchId
    opened_s: float
    version: str
    words: str
    request: OpenSearch
    specs: ComponentSpecs
    config: HyPerNavConfig
    memory: Path | None = None
    memory_mb: float | None = None
    relocalize: bool = False
    memory_save: str | None = None
    earlier_searches: int | None = None


class StepRecord(Message):
    """One decision.

    Attributes:
        reply: What the robot was told.
        trace: What the agent knew and decided; None if the search ended at the step limit, or the
            robot still turns to find out where it is in the memory.
        start: Where it is there; None if it knew, or still turns.
        doubts: What the robot sends that may be misread, as told so far.
    """

    reply: Reply
    trace: StepTrace | None
    start: StartInMemory | None = None
    doubts: tuple[str, ...] = ()


class EndRecord(Message):
    """The end of a search.

    Attributes:
        ending: How it ended.
        detail: Why, for people.
    """

    ending: SearchEnding
    detail: str = ""


class Journal:
    """The folder of one search. Not thread-safe, except `write_end`."""

    def __init__(self, folder: Path, *, to_read: bool = False) -> None:
        """Open the folder of a search; see `create` for a new one.

        Args:
            folder: The folder.
            to_read: Whether to open it for reading only.

        Raises:
            RunFolderError: It is damaged, or cannot be written.
        """
        self.folder = folder
        self._ending = threading.Lock()
        self.record = _read(folder / "search.json", SearchRecord)
        self._observations = RecordFile(folder / "observations.bin", to_read=to_read)
        self._steps = RecordFile(folder / "steps.bin", to_read=to_read)
        if not to_read:
            # After a loss of power a decision may be on the disk without its observation.
            self._steps.cut(len(self._observations))

    @staticmethod
    def create(folder: Path, record: SearchRecord) -> "Journal":
        """Make the folder of a new search.

        Raises:
            RunFolderError: It cannot be written.
        """
        try:
            folder.mkdir(mode=0o700, exist_ok=True)
            _fresh(folder / _END_FILE).write_bytes(bytes(_ROOM_FOR_END))
        except OSError as error:
            raise RunFolderError(f"cannot create {folder}: {error.strerror}") from error
        _write_whole(folder / "search.json", record)
        return Journal(folder)

    @property
    def end(self) -> EndRecord | None:
        """How the search ended; None as long as it goes on."""
        path = self.folder / _END_FILE
        return _read(path, EndRecord) if path.exists() else None

    @property
    def observation_count(self) -> int:
        """Number of observations."""
        return len(self._observations)

    @property
    def step_count(self) -> int:
        """Number of decisions: as many as observations, or one less."""
        return len(self._steps)

    def observation(self, number: int) -> bytes:
        """An observation as it was received."""
        return self._observations.read(number)

    def image_of(self, number: int) -> tuple[str, bytes] | None:
        """Format and bytes of an observation's colour image; None if it has not come.

        Raises:
            HyPerNavError: It is damaged on the disk.
        """
        if not 0 <= number < self.observation_count:
            return None
        packed = unpack_observation(self.observation(number))
        return packed.header.colour.format, packed.colour

    def height_of(self, number: int) -> float:
        """Height of the robot at an observation, in the frame of its poses, metres.

        Raises:
            HyPerNavError: The observation is damaged on the disk.
        """
        header = unpack_observation(self.observation(number)).header
        return float(header.base_to_map.translation[2])

    def step(self, number: int) -> StepRecord:
        """A decision.

        Raises:
            RunFolderError: It is damaged on the disk.
        """
        record = self._steps.read(number)
        try:
            return StepRecord.model_validate_json(record)
        except ValidationError as error:
            raise _damaged(self._steps.path, error) from error

    def trace_lines(self, since: int) -> Iterator[str]:
        """The traces of the decisions as JSON, from a number on."""
        for number in range(since, len(self._steps)):
            trace = json.loads(self._steps.read(number))["trace"]
            if trace is not None:
                yield json.dumps(trace, ensure_ascii=False) + "\n"

    def add_observation(self, body: bytes) -> None:
        """Write an observation to disk before it is processed.

        Raises:
            RunFolderError: It cannot be written; the journal is unchanged.
        """
        self._observations.append(body, sync=False)

    def add_step(self, step: StepRecord) -> None:
        """Write a decision, and wait until it and its observation are on the disk.

        Raises:
            RunFolderError: It cannot be written.
        """
        self._observations.sync()
        self._steps.append(step.model_dump_json().encode(), sync=True)

    def write_end(self, end: EndRecord, maps: Mapping[int, OccupancyGrid], last_floor: int) -> None:
        """Write the end of the search, and its maps.

        Args:
            end: How the search ended.
            maps: Last map of every floor, by its number.
            last_floor: Number of the floor where it ended.

        Raises:
            RunFolderError: It cannot be written.
        """
        with self._ending:
            _write_whole(self.folder / _END_FILE, end)
            for floor in sorted(maps, key=lambda one: one != last_floor):
                with suppress(OSError):  # a missing map does not matter
                    save_ros_map(maps[floor], self._map_file(floor, last_floor).parent)

    def read_maps(self, last_floor: int) -> dict[int, OccupancyGrid]:
        """The last map of every floor of a search that has ended, by its number.

        Args:
            last_floor: Number of the floor where it ended.
        """
        names = [one.name.removeprefix(_FLOOR) for one in self.folder.glob(f"{_FLOOR}*")]
        floors = {last_floor, *(int(one) for one in names if re.fullmatch("[0-9]+", one))}
        maps = {floor: self.read_map(floor, last_floor) for floor in floors}
        return {floor: grid for floor, grid in maps.items() if grid is not None}

    def read_map(self, floor: int, last_floor: int) -> OccupancyGrid | None:
        """The last map of a floor of a search that has ended; None if there is none.

        Args:
            floor: Number of the floor.
            last_floor: Number of the floor where it ended.
        """
        file = self._map_file(floor, last_floor)
        return load_ros_map(file) if file.exists() else None

    @property
    def is_paused(self) -> bool:
        """Whether people keep the search waiting; it is on disk, so a restart resumes nothing."""
        return (self.folder / _PAUSED_FILE).exists()

    def write_paused(self, is_paused: bool) -> None:
        """Note whether people keep the search waiting.

        Raises:
            RunFolderError: It cannot be written.
        """
        file = self.folder / _PAUSED_FILE
        try:
            if is_paused:
                os.close(own_descriptor(file))
            else:
                file.unlink(missing_ok=True)
        except OSError as error:
            raise RunFolderError(f"{file} cannot be written ({error.strerror})") from error

    @property
    def closed(self) -> ClosedSpans:
        """The places that people closed to the robot.

        Raises:
            RunFolderError: They are damaged on the disk.
        """
        path = self.folder / _NO_ENTRY_FILE
        return _read(path, ClosedSpans) if path.exists() else ClosedSpans()

    def write_closed(self, closed: ClosedSpans) -> None:
        """Note the places that people closed to the robot.

        Raises:
            RunFolderError: It cannot be written; what was noted before stays.
        """
        _write_whole(self.folder / _NO_ENTRY_FILE, closed)

    @property
    def sent(self) -> SentSpans:
        """The places that people sent the robot to.

        Raises:
            RunFolderError: They are damaged on the disk.
        """
        path = self.folder / _GO_TO_FILE
        return _read(path, SentSpans) if path.exists() else SentSpans()

    def write_sent(self, sent: SentSpans) -> None:
        """Note the places that people sent the robot to.

        Raises:
            RunFolderError: It cannot be written; what was noted before stays.
        """
        _write_whole(self.folder / _GO_TO_FILE, sent)

    @property
    def has_map(self) -> bool:
        """Whether the final map was written."""
        return (self.folder / _MAP_FILE).exists()

    def _map_file(self, floor: int, last_floor: int) -> Path:
        folder = self.folder if floor == last_floor else self.folder / f"{_FLOOR}{floor}"
        return folder / _MAP_FILE

    def close(self) -> None:
        """Close the files."""
        self._observations.close()
        self._steps.close()


def _read(path: Path, model: type[_Model]) -> _Model:
    try:
        return model.model_validate_json(read_own(path, most=_MOST_BYTES))
    except OSError as error:
        raise RunFolderError(f"cannot read {path}: {error.strerror}") from error
    except (ValidationError, HyPerNavError) as error:
        raise _damaged(path, error) from error


def _damaged(path: Path, error: Exception) -> RunFolderError:
    return RunFolderError(f"{path} was damaged: {' '.join(str(error).split())[:200]}")


def _write_whole(path: Path, content: BaseModel) -> None:
    """Replace a file in one step and wait for the disk; uses the space reserved for it."""
    fresh = _fresh(path)
    try:
        with open(own_descriptor(fresh), "r+b") as file:
            file.write(content.model_dump_json(indent=1).encode())
            file.truncate()
            file.flush()
            os.fsync(file.fileno())
        fresh.replace(path)
    except OSError as error:
        raise RunFolderError(f"{path} cannot be written: {error.strerror}") from error


def _fresh(path: Path) -> Path:
    """The temporary file for the next content of another."""
    return path.with_name(f".{path.name}.new")
