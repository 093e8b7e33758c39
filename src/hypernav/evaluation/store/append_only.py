"""Writing of files that are complete at any moment, even after a crash or on a full disk."""

import os
from pathlib import Path

from hypernav.core.errors import RunFolderError


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


def write_whole(path: Path, content: str | bytes) -> None:
    """Replace a file in one step, so that nobody reads half of it, and wait for the disk.

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
        "Free some space, then run the same command again: it resumes from here"
    )
