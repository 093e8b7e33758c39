"""A file of records, each preceded by its length and checksum; complete records can be read."""

import struct
import zlib
from collections.abc import Iterator
from pathlib import Path

from hypernav.core.errors import RunFolderError
from hypernav.io.writing import AppendOnlyFile

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
