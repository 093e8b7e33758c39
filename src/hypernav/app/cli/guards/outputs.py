"""Checks outputs before the work begins, so that no search is lost because of a folder."""

import tempfile
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from hypernav.core.errors import ConfigError, OutputError
from hypernav.io.writing import check_regular


def check_folder(folder: Path, files: Iterable[str] = ()) -> None:
    """Make sure that files can be written to a folder, by writing one.

    A missing folder is created and removed again, so that a command that fails leaves nothing.

    Args:
        folder: The folder.
        files: Names of the files that will be written to it: nothing else may lie in their way.

    Raises:
        OutputError: They cannot be written; the message names the folder and the reason.
    """
    try:
        if folder.exists() and not folder.is_dir():
            raise OutputError(f"{folder} is not a folder; results go to a folder, choose another")
        missing = [path for path in (folder, *folder.parents) if not path.exists()]
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=folder) as file:
                file.write(b"a byte, as full disks take none")
                file.flush()
        finally:
            for path in missing:
                with suppress(OSError):
                    path.rmdir()
    except OSError as error:
        raise OutputError(
            f"{folder} cannot be written ({error.strerror}); choose a folder where files can be "
            "made"
        ) from error
    for name in files:
        check_regular(folder / name)
        if (folder / name).is_symlink():  # the folder may be a stranger's
            raise OutputError(
                f"{folder / name} is a link where a file of the folder's own would be; remove it, "
                "or choose another folder"
            )


def check_file(path: Path) -> None:
    """Make sure that a file can be created or replaced: a regular one, not a pipe or a device.

    Raises:
        OutputError: It cannot be; the message names the file and the reason.
    """
    check_regular(path)
    check_folder(path.parent)


def check_apart(folder: Path, memory: Path) -> None:
    """Refuse to write results to the folder of a memory, or into it.

    Raises:
        ConfigError: They would be; the message names ``--out``.
    """
    results, home = folder.resolve(), memory.resolve()
    if results == home:
        raise ConfigError(f"--out {folder} is the folder of --memory; choose another")
    if results.is_relative_to(home):
        raise ConfigError(
            f"--out {folder} lies in the memory, whose files it could replace; choose another"
        )
