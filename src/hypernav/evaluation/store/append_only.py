"""Files that are whole at any moment, whatever happens to the program or the disk."""

import os
from pathlib import Path

from hypernav.core.errors import RunFolderError


def append_line(path: Path, line: str) -> None:
    """Add a line to a file and wait until it is on the disk; all of it, or none.

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
            # Making a file shorter needs no room on the disk.
            os.ftruncate(file, size)
            raise _unwritable(path, error) from error
    finally:
        os.close(file)


def write_whole(path: Path, content: str | bytes) -> None:
    """Write a file so that nobody ever sees half of it, and wait until it is on the disk.

    Raises:
        RunFolderError: The disk is full, or the file can't be written. The file is as before.
    """
    fresh = path.with_name(f".{path.name}.new")
    try:
        with fresh.open("wb") as file:
            file.write(content.encode() if isinstance(content, str) else content)
            file.flush()
            os.fsync(file.fileno())
        fresh.replace(path)
    except OSError as error:
        fresh.unlink(missing_ok=True)
        raise _unwritable(path, error) from error


def _write_all(file: int, data: bytes) -> None:
    while data:
        data = data[os.write(file, data) :]


def _unwritable(path: Path, error: OSError) -> RunFolderError:
    return RunFolderError(
        f"{path} cannot be written ({error.strerror or error}); every episode up to now is safe. "
        "Make room, then run the same command again: it goes on from here"
    )
