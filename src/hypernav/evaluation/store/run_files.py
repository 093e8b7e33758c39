"""Files of a run's folder: complete at any moment, even after a crash or on a full disk."""

from contextlib import closing
from pathlib import Path

from hypernav.core.errors import RunFolderError
from hypernav.io import writing
from hypernav.io.writing import AppendOnlyFile


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
    return RunFolderError(
        f"{path} cannot be written ({error.strerror or error}); every episode up to now is safe. "
        "Free some space, then run the same command again: it resumes from here"
    )
