"""Reads files from outside: only regular files, of limited size, within their folder."""

import codecs
import errno
import os
import stat
from pathlib import Path

from hypernav.core.files.allowance import MOST_BYTES, megabytes

_KINDS = (
    (stat.S_ISDIR, errno.EISDIR, "a folder"),
    (stat.S_ISCHR, errno.EINVAL, "a device"),
    (stat.S_ISBLK, errno.EINVAL, "a device"),
    (stat.S_ISFIFO, errno.EINVAL, "a pipe"),
    (stat.S_ISSOCK, errno.EINVAL, "a socket"),
)


def read_file(path: Path, *, most: int = MOST_BYTES) -> bytes:
    """The content of a regular file.

    Args:
        path: Path of the file.
        most: Largest size that is read, bytes.

    Raises:
        OSError: It cannot be read, is no regular file (a device may never end), or is too large.
    """
    # An ordinary open would block on a pipe without a writer.
    with open(path, "rb", opener=_open_at_once) as file:
        size = _checked_size(os.fstat(file.fileno()), most)
        if size == 0 and file.read(1):
            raise OSError(errno.EINVAL, "it is a file of the kernel, expected one on a disk")
        return file.read(size)


def text_of(content: bytes, *, errors: str = "strict") -> str:
    """The text of a file: UTF-8, or the UTF-16 of Windows, with or without a byte order mark.

    Args:
        content: Content of the file.
        errors: What happens to bytes that are no text, as in `bytes.decode`.

    Raises:
        UnicodeDecodeError: The content is no text.
    """
    is_wide = content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    return content.decode("utf-16" if is_wide else "utf-8-sig", errors)


def check_file(path: Path, *, most: int = MOST_BYTES) -> None:
    """Refuse a file that `read_file` would refuse, for libraries that open files themselves.

    Raises:
        OSError: It does not exist, is no regular file, or is too large.
    """
    _checked_size(os.stat(path), most)


def path_below(folder: Path, reference: str) -> Path:
    """The file that a relative reference names. Symbolic links in the folder may lead out of it.

    Args:
        folder: Folder that the reference must not leave.
        reference: Relative path with ``/`` between its parts.

    Raises:
        OSError: The reference leads out of the folder, or is no path at all.
    """
    if not reference.isprintable():
        raise OSError(errno.EINVAL, "its name holds characters that no name can have")
    path = Path(os.path.normpath(folder / reference))
    if not path.is_relative_to(os.path.normpath(folder)):
        raise OSError(errno.EPERM, "it lies outside the folder")
    return path


def back_slashes(path: str) -> str:
    """What to say of the back slashes in a path that leads nowhere; empty if it has none."""
    if "\\" not in path or os.sep == "\\":
        return ""
    return "; its back slashes separate no folders here: write / in their place"


def _open_at_once(path: str, flags: int) -> int:
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))


def _checked_size(status: os.stat_result, most: int) -> int:
    for is_of_kind, code, kind in _KINDS:
        if is_of_kind(status.st_mode):
            raise OSError(code, f"it is {kind}, expected a file")
    if status.st_size > most:
        raise OSError(
            errno.EFBIG,
            f"it has {megabytes(status.st_size)}, at most {megabytes(most)} are read",
        )
    return status.st_size
