"""A lock that lets one process at a time write a folder, kept by the operating system.

The system releases the lock of a killed process at once, so no stale lock is ever left.
"""

import os
import socket
import sys
from pathlib import Path
from types import TracebackType

from hypernav.core.errors import RunFolderError

LOCK_NAME = ".lock"


class FolderLock:
    """Lock of a folder, held while the ``with`` block runs."""

    def __init__(self, folder: Path, *, option: str = "--out") -> None:
        """Name the folder; it is created, if missing, when the lock is taken.

        Args:
            folder: The folder.
            option: Option that chooses another one, for the message.
        """
        self._path = folder / LOCK_NAME
        self._option = option
        self._file: int | None = None

    def __enter__(self) -> "FolderLock":
        """Take the lock.

        Raises:
            RunFolderError: Another process holds it, or the folder can't be written.
        """
        folder = self._path.parent
        try:
            folder.mkdir(parents=True, exist_ok=True)
            file = os.open(self._path, os.O_RDWR | os.O_CREAT, 0o644)
        except OSError as error:
            raise RunFolderError(
                f"{folder} cannot be written: {error.strerror or error}"
            ) from error
        if not _lock(file):
            owner = os.read(file, 200).decode(errors="replace").strip()
            os.close(file)
            raise RunFolderError(
                f"{folder} is in use by another run ({owner or 'owner unknown'}); wait "
                f"for it, stop it, or choose another {self._option}"
            )
        os.ftruncate(file, 0)
        os.write(file, f"process {os.getpid()} on {socket.gethostname()}\n".encode())
        self._file = file
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Release the lock."""
        if self._file is not None:
            os.close(self._file)
            self._file = None


if sys.platform == "win32":
    import msvcrt

    _FAR_AWAY = 1 << 30

    def _lock(file: int) -> bool:
        # A region far behind the text, so that others can still read who the owner is.
        os.lseek(file, _FAR_AWAY, os.SEEK_SET)
        try:
            msvcrt.locking(file, msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        finally:
            os.lseek(file, 0, os.SEEK_SET)
        return True

else:
    import fcntl

    def _lock(file: int) -> bool:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        return True
