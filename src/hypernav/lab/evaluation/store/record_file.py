"""A file of records for any kind of study, with one line for every finished episode.

Files of a run's folder are complete at any moment, even after a crash or on a full disk.
"""

import logging
from contextlib import closing
from pathlib import Path
from typing import Generic, TypeVar

from pydantic import ValidationError

from hypernav.core.errors import RunFolderError
from hypernav.io import writing
from hypernav.io.foreign_folder import NotOwnError, read_own
from hypernav.io.writing import AppendOnlyFile
from hypernav.lab.evaluation.record import EpisodeKey, EpisodeLine


def append_line(path: Path, line: str) -> None:
    """Append a line to a file, completely or not at all, and wait until it is on the disk.

    Raises:
        RunFolderError: The disk is full, or the file can't be written. The file is unchanged.
    """
    try:
        with closing(AppendOnlyFile(path)) as file:
            file.append(line.encode() + b"\n", sync=True)
    except OSError as error:
        raise _unwritable(path, error) from error


def write_whole(path: Path, content: str | bytes) -> None:
    """Replace a file of a run's folder in one step, and wait for the disk.

    Raises:
        RunFolderError: The disk is full, or the file can't be written. The file is unchanged.
    """
    try:
        writing.write_whole(path, content)
    except OSError as error:
        raise _unwritable(path, error) from error


def _unwritable(path: Path, error: OSError) -> RunFolderError:
    if not path.parent.is_dir():
        return RunFolderError(
            f"{path.parent} was removed while the run wrote to it, with the episodes up to now; "
            "put it back and run the same command again, or begin anew"
        )
    if isinstance(error, NotOwnError):
        return RunFolderError(f"{path} cannot be written ({error.strerror}); remove that")
    return RunFolderError(
        f"{path} cannot be written ({error.strerror or error}); every episode up to now is safe. "
        "Free some space, then run the same command again: it resumes from here"
    )


_LOGGER = logging.getLogger(__name__)


Record = TypeVar("Record", bound=EpisodeLine)


class RecordFile(Generic[Record]):
    """The records of a folder, for its only writer.

    A line is on the disk before the next one is written, so a crash loses only running episodes.

    Attributes:
        records: Records of the finished episodes, by key, in the order in which they were done.
    """

    def __init__(self, path: Path, kind: type[Record]) -> None:
        """Read the finished episodes; a truncated last line is moved to another file.

        Raises:
            RunFolderError: A line cannot be read, or an episode is there twice.
        """
        self._path = path
        _repair_last_line(path, kind)
        self.records: dict[EpisodeKey, Record] = read_record_file(path, kind)

    def add(self, record: Record) -> None:
        """Write the record of one episode to the disk.

        Raises:
            RunFolderError: The episode has a record already, or the disk is full.
        """
        if record.key in self.records:
            raise RunFolderError(
                f"{self._path.parent}: episode {'/'.join(record.key)} is done already"
            )
        append_line(self._path, record.model_dump_json())
        self.records[record.key] = record


def read_record_file(path: Path, kind: type[Record]) -> dict[EpisodeKey, Record]:
    """All records of a file by key; none where there is no file.

    Raises:
        RunFolderError: A line cannot be read, or an episode is there twice.
    """
    records: dict[EpisodeKey, Record] = {}
    for number, line in enumerate(file_content(path).splitlines(), start=1):
        try:
            record = kind.model_validate_json(line)
        except ValidationError as error:
            raise RunFolderError(
                f"{path}, line {number} is damaged ({error.errors()[0]['msg']}); nothing was "
                "changed. Remove that line and run again: its episode will be repeated"
            ) from error
        if record.key in records:
            raise RunFolderError(
                f"{path}, line {number}: episode {'/'.join(record.key)} is there twice; nothing "
                "was changed. Remove one of the lines"
            )
        records[record.key] = record
    return records


def file_content(path: Path) -> bytes:
    """The bytes of a file of the folder; empty where there is none.

    Raises:
        RunFolderError: It cannot be read, or is no file of the folder's own.
    """
    try:
        return read_own(path)
    except FileNotFoundError:
        return b""
    except OSError as error:
        raise RunFolderError(f"{path} cannot be read: {error.strerror or error}") from error


def _repair_last_line(path: Path, kind: type[Record]) -> None:
    """Move a truncated last line to a file of its own."""
    content = file_content(path)
    start = content.rstrip(b"\n").rfind(b"\n") + 1
    last = content[start:]
    if not last.strip(b"\n"):
        return
    if _is_record(last, kind):
        if not last.endswith(b"\n"):
            append_line(path, "")
        return
    backup = _free_name(path.with_name(path.name + ".cut"))
    write_whole(backup, last)
    write_whole(path, content[:start])
    _LOGGER.warning(
        "%s: the last line was not written to its end; it was moved to %s, and its episode runs "
        "again",
        path,
        backup.name,
    )


def _is_record(line: bytes, kind: type[Record]) -> bool:
    try:
        kind.model_validate_json(line)
    except ValidationError:
        return False
    return True


def _free_name(path: Path) -> Path:
    number = 1
    while (candidate := path.with_name(f"{path.name}-{number}")).exists():
        number += 1
    return candidate
