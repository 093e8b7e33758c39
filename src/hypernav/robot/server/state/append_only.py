"""A file that only grows, whole record by whole record, whatever kills the program."""

import os
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path

from hypernav.core.errors import RunFolderError

_HEADER = struct.Struct("<II")


class AppendOnlyFile:
    """Records, each behind its length and checksum. What a crash left of the last one is cut off.

    Not thread-safe.
    """

    def __init__(self, path: Path, *, to_read: bool = False) -> None:
        """Open the file, or make it, and go on behind its last whole record.

        Args:
            path: Path of the file.
            to_read: Whether to leave the file as it is, since somebody else may be writing it.

        Raises:
            RunFolderError: It cannot be opened.
        """
        self.path = path
        try:
            self._file = os.open(path, os.O_RDONLY if to_read else os.O_RDWR | os.O_CREAT, 0o600)
            self.offsets = list(_whole_records(self._file))
            self._end = self.offsets.pop()
            if not to_read:
                os.ftruncate(self._file, self._end)
        except OSError as error:
            raise _unwritable(path, error) from error

    def __len__(self) -> int:
        """Number of records."""
        return len(self.offsets)

    def append(self, record: bytes, *, sync: bool) -> None:
        """Write a record, all of it or nothing.

        Args:
            record: Its bytes.
            sync: Whether to wait until it, and all before it, are on the disk. Without that they
                survive the end of this program, but not of the power.

        Raises:
            RunFolderError: The disk is full, or the file cannot be written. It is as before.
        """
        data = _HEADER.pack(len(record), zlib.crc32(record)) + record
        try:
            _write_all(self._file, data, self._end)
            if sync:
                os.fsync(self._file)
        except OSError as error:
            os.ftruncate(self._file, self._end)  # needs no space on the disk
            raise _unwritable(self.path, error) from error
        self.offsets.append(self._end)
        self._end += len(data)

    def sync(self) -> None:
        """Wait until all records are on the disk.

        Raises:
            RunFolderError: The disk fails.
        """
        try:
            os.fsync(self._file)
        except OSError as error:
            raise _unwritable(self.path, error) from error

    def read(self, number: int) -> bytes:
        """A record by its number, from 0.

        Raises:
            RunFolderError: The file was damaged.
        """
        at = self.offsets[number]
        length, checksum = _HEADER.unpack(os.pread(self._file, _HEADER.size, at))
        record = os.pread(self._file, length, at + _HEADER.size)
        if len(record) != length or zlib.crc32(record) != checksum:
            raise RunFolderError(f"{self.path}: record {number} was damaged since it was written")
        return record

    def cut(self, count: int) -> None:
        """Keep the first records only."""
        if count < len(self.offsets):
            self._end = self.offsets[count]
            del self.offsets[count:]
            os.ftruncate(self._file, self._end)

    def close(self) -> None:
        """Close the file."""
        os.close(self._file)


def _whole_records(file: int) -> Iterator[int]:
    """Offsets of the records, and of the end of the last one that is whole."""
    size, at = os.fstat(file).st_size, 0
    while True:
        yield at
        header = os.pread(file, _HEADER.size, at)
        if len(header) < _HEADER.size:
            return
        length, checksum = _HEADER.unpack(header)
        end = at + _HEADER.size + length
        if end > size:
            return
        if end == size and zlib.crc32(os.pread(file, length, at + _HEADER.size)) != checksum:
            return
        at = end


def _write_all(file: int, data: bytes, at: int) -> None:
    view = memoryview(data)
    while view:
        written = os.pwrite(file, view, at)
        view, at = view[written:], at + written


def _unwritable(path: Path, error: OSError) -> RunFolderError:
    return RunFolderError(
        f"{path} cannot be written ({error.strerror or error}); what was answered up to now is "
        "there. Free some space and go on"
    )
