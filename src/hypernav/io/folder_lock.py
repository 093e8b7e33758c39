"""A lock of the operating system that lets one process at a time write a folder.

The system releases the lock of a killed process at once, so no stale lock is ever left.
"""

import errno
import fcntl
import os
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from hypernav.core.errors import RunFolderError
from hypernav.io.foreign_folder import ForeignFolder

LOCK_NAME = ".lock"
_OWNER_NAME = ".lock.owner"  # replaced, never written in place: a link may share a stranger's file
_MOST_OWNER_BYTES = 1000
_EVERY_S = 0.05


@contextmanager
def folder_lock(
    folder: Path, *, option: str = "--out", patience_s: float = 0.0, to_read: bool = False
) -> Iterator[ForeignFolder]:
    """Hold the lock of a folder, which is created if missing, while the ``with`` block runs.

    Args:
        folder: The folder.
        option: Option that chooses another folder, for the message.
        patience_s: Longest wait for another holder, seconds.
        to_read: Whether the folder is only read: on a read-only file system, on which nobody writes
            it, no lock is needed then.

    Yields:
        The folder, open.

    Raises:
        RunFolderError: Another process holds it, or the folder can't be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        home = ForeignFolder(folder)
    except OSError as error:
        raise _unusable(folder, option, error) from error
    with home:
        lock = None
        try:
            lock = home.descriptor_of(LOCK_NAME, os.O_RDWR | os.O_CREAT)
            _acquire(lock, patience_s)
            owner = f"process {os.getpid()} on {socket.gethostname()}\n"
            home.write(_OWNER_NAME, owner, sync=False)
        except BlockingIOError as error:
            _close(lock)
            raise RunFolderError(
                f"{folder} is in use by another run ({_owner_of(home)}); wait for it, stop it, or "
                f"choose another {option}"
            ) from error
        except OSError as error:
            _close(lock)
            if not (to_read and error.errno == errno.EROFS):
                raise _unusable(folder, option, error) from error
            lock = None
        try:
            yield home
        finally:
            _close(lock)


def _acquire(lock: int, patience_s: float) -> None:
    """Take the lock.

    Raises:
        BlockingIOError: Another process holds it for longer than the patience, seconds.
        OSError: The file system has no locks. There is no fallback: a plain file would outlive a
            killed process.
    """
    until_s = time.monotonic() + patience_s
    while True:
        try:
            return fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            if time.monotonic() >= until_s:
                raise
        time.sleep(_EVERY_S)


def _close(lock: int | None) -> None:
    """Release the lock at once, even if a process that was begun meanwhile has its file open."""
    if lock is not None:
        fcntl.flock(lock, fcntl.LOCK_UN)
        os.close(lock)


def _owner_of(home: ForeignFolder) -> str:
    try:
        name = home.read(_OWNER_NAME, most=_MOST_OWNER_BYTES).decode("utf-8", "replace")
    except OSError:
        name = ""
    return name.strip() or "owner unknown"


def _unusable(folder: Path, option: str, error: OSError) -> RunFolderError:
    return RunFolderError(
        f"{folder} cannot be written ({error.strerror or error}); make that possible, or choose "
        f"another {option}"
    )
