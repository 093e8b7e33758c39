"""Writing of files that are complete at any moment, even after a crash or on a full disk."""

import os
from pathlib import Path

from hypernav.core.errors import RunFolderError
from hypernav.core.files import whole_files


def append_line(path: Path, line: str) -> None:
    """Append a line to a file, all of it or nothing, and wait until it is on the disk.

    Raises:
        RunFolderError: The disk is full, or the file can't be written. The file is as before.
    """
    data = line.encode() + b"\n"
    try:
        file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o644)
    except OSError as error:
        raise _unwritable(path, error) from error
    try:
        size = os.fstat(file).st_size
        try:
            _write_all(file, data)
            os.fsync(file)
        except OSError as error:
            # Truncating a file needs no space on the disk.
            os.ftruncate(file, size)
            raise _unwritable(path, error) from error
    finally:
        os.close(file)


class LineFile:
    """A new file of lines. Each is with the operating system at once, as a whole or not at all."""

    def __init__(self, path: Path) -> None:
        """Open the file; one that is there is replaced.

        Raises:
            OSError: It cannot be written.
        """
        self._file = path.open("wb", buffering=0)

    def add(self, line: str) -> None:
        """Write a line.

        Raises:
            OSError: The disk is full; the file is as before.
        """
        size = self._file.tell()
        try:
            _write_all(self._file.fileno(), line.encode() + b"\n")
        except OSError:
            self._file.seek(size)
            self._file.truncate()
            raise

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def write_whole(path: Path, content: str | bytes) -> None:
    """Replace a file of a run's folder in one step, and wait for the disk.

    Raises:
        RunFolderError: The disk is full, or the file can't be written. The file is as before.
    """
    try:
        whole_files.write_whole(path, content)
    except OSError as error:
        raise _unwritable(path, error) from error


def _write_all(file: int, data: bytes) -> None:
    while data:
        data = data[os.write(file, data) :]


def _unwritable(path: Path, error: OSError) -> RunFolderError:
    return RunFolderError(
        f"{path} cannot be written ({error.strerror or error}); every episode up to now is safe. "
        "Free some space, then run the same command again: it resumes from here"
    )
