"""A lock of the operating system that lets one process at a time write a folder.

The system releases the lock of a killed process at once, so no stale lock is ever left.
"""

import errno
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from filelock import FileLock, Timeout

from hypernav.core.errors import RunFolderError

LOCK_NAME = ".lock"
_OWNER_NAME = ".lock.owner"  # not in the lock file, which others can't read on Windows


@contextmanager
def folder_lock(
    folder: Path, *, option: str = "--out", patience_s: float = 0.0, to_read: bool = False
) -> Iterator[None]:
    """Hold the lock of a folder, which is created if missing, while the ``with`` block runs.

    Args:
        folder: The folder.
        option: Option that chooses another folder, for the message.
        patience_s: Longest wait for another holder, seconds.
        to_read: Whether the folder is only read: on a read-only file system, on which nobody writes
            it, no lock is needed then.

    Raises:
        RunFolderError: Another process holds it, or the folder can't be written.
    """
    # No fallback for file systems without locks: a plain file would outlive a killed process.
    lock = FileLock(
        folder / LOCK_NAME, timeout=patience_s, thread_local=False, fallback_to_soft=False
    )
    owner = folder / _OWNER_NAME
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock.acquire()
        owner.write_text(f"process {os.getpid()} on {socket.gethostname()}\n", encoding="utf-8")
    except Timeout as error:
        name = owner.read_text("utf-8", "replace").strip() if owner.is_file() else "owner unknown"
        raise RunFolderError(
            f"{folder} is in use by another run ({name or 'owner unknown'}); wait "
            f"for it, stop it, or choose another {option}"
        ) from error
    except OSError as error:
        lock.release()
        if to_read and error.errno == errno.EROFS:
            yield
            return
        raise RunFolderError(
            f"{folder} cannot be written ({error.strerror or error}); make that possible, or "
            f"choose another {option}"
        ) from error
    try:
        yield
    finally:
        lock.release()
