"""Reads files from outside: only regular files, of limited size, within their folder.

The sizes of encoded images are read from their headers alone.
"""

import codecs
import errno
import os
import re
import stat
import struct
from itertools import islice
from pathlib import Path
from typing import BinaryIO

from hypernav.core.naming.words import megabytes

MOST_BYTES = 2_000_000_000
"""The limit, bytes. A scan of a large house with a hundred textures of 2048² stays below."""

_KINDS = (
    (stat.S_ISDIR, errno.EISDIR, "a folder"),
    (stat.S_ISCHR, errno.EINVAL, "a device"),
    (stat.S_ISBLK, errno.EINVAL, "a device"),
    (stat.S_ISFIFO, errno.EINVAL, "a pipe"),
    (stat.S_ISSOCK, errno.EINVAL, "a socket"),
    (stat.S_ISLNK, errno.ELOOP, "a link"),
)

MOST_PIXELS = 8192 * 4096
"""The largest image that is decoded."""

PNG, JPEG = b"\x89PNG\r\n\x1a\n", b"\xff\xd8"
"""How such images begin."""
_RIFF, _WEBP = b"RIFF", b"WEBP"
_MOST_CHUNKS = 1_000_000
_START_OF_SCAN = re.compile(rb"\xff\xda")  # ten times as fast as `bytes.count`
_MOST_SCANS = 100
"""Largest number of scans of a JPEG: each costs a pass over the image, but few bytes of file."""
_FRAME_HEADERS = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
_WITHOUT_LENGTH = frozenset({0x01, *range(0xD0, 0xD9)})


class Allowance:
    """The memory that one file, or one folder, may still make this program allocate."""

    def __init__(self, whole: str = "a file") -> None:
        """Create it with the whole of `MOST_BYTES`.

        Args:
            whole: What it is for, for the message.
        """
        self._left = MOST_BYTES
        self._whole = whole

    def spend(self, size: int, what: str) -> None:
        """Account for memory that is about to be allocated.

        Args:
            size: Size of the memory, bytes.
            what: Content of the memory, for the message.

        Raises:
            OSError: The file asks for more than it may (``EFBIG``).
        """
        self._left -= size
        if self._left < 0:
            raise OSError(
                errno.EFBIG,
                f"{what} would take {megabytes(size)}, all of {self._whole} at most "
                f"{megabytes(MOST_BYTES)}",
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
        return content_of(file, most=most)


def content_of(file: BinaryIO, *, most: int) -> bytes:
    """The content of an open file, as `read_file` has it."""
    size = _checked_size(os.fstat(file.fileno()), most)
    if size == 0 and file.read(1):
        raise OSError(errno.EINVAL, "it is a file of the kernel, expected one on a disk")
    return file.read(size)


def kind_of(status: os.stat_result) -> tuple[int, str] | None:
    """What is no regular file: the number of its error, and what it is; None for a file."""
    if stat.S_ISREG(status.st_mode):
        return None
    kinds = ((code, kind) for is_kind, code, kind in _KINDS if is_kind(status.st_mode))
    return next(kinds, (errno.EINVAL, "no regular file"))


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
    if (kind := kind_of(status)) is not None:
        raise OSError(kind[0], f"it is {kind[1]}, expected a file")
    if status.st_size > most:
        raise OSError(
            errno.EFBIG,
            f"it has {megabytes(status.st_size)}, at most {megabytes(most)} are read",
        )
    return status.st_size


def image_size(data: bytes) -> tuple[int, int] | None:
    """Width and height of a PNG, JPEG or WebP image, pixels.

    Args:
        data: The encoded image.

    Returns:
        None if it has another format, or its header is broken.
    """
    try:
        if data.startswith(PNG):
            return struct.unpack_from(">II", data, 16) if _holds_its_chunks(data) else None
        if data.startswith(JPEG):
            scans = _START_OF_SCAN.finditer(data)
            return None if any(islice(scans, _MOST_SCANS, None)) else _jpeg_size(data)
        if data.startswith(_RIFF) and data[8:12] == _WEBP:
            return _webp_size(data)
    except (struct.error, IndexError):
        pass
    return None


def _holds_its_chunks(data: bytes) -> bool:
    """Whether no chunk of a PNG says that it is longer than the file: decoders allocate first."""
    at = len(PNG)
    for _ in range(_MOST_CHUNKS):
        if at + 8 > len(data):
            return at <= len(data)
        at += 12 + int.from_bytes(data[at : at + 4], "big")
    return False


def _jpeg_size(data: bytes) -> tuple[int, int] | None:
    at = data.find(b"\xff", 2)
    while at >= 0:
        marker = data[at + 1]
        if marker == 0xFF:
            at += 1
        elif marker in _FRAME_HEADERS:
            height, width = struct.unpack_from(">HH", data, at + 5)
            return width, height
        else:
            length = 0 if marker in _WITHOUT_LENGTH else struct.unpack_from(">H", data, at + 2)[0]
            at = data.find(b"\xff", at + 2 + length)
    return None


def _webp_size(data: bytes) -> tuple[int, int] | None:
    kind = data[12:16]
    if kind == b"VP8X":
        width, height = (int.from_bytes(data[at : at + 3], "little") + 1 for at in (24, 27))
        return width, height
    if kind == b"VP8L":
        bits = struct.unpack_from("<I", data, 21)[0]
        return (bits & 0x3FFF) + 1, (bits >> 14 & 0x3FFF) + 1
    if kind == b"VP8 ":
        width, height = struct.unpack_from("<HH", data, 26)
        return width & 0x3FFF, height & 0x3FFF
    return None
