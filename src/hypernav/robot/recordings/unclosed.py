"""MCAP files that were never closed: what is whole in them, with the end that they lack.

After a loss of power a file has no footer, and its last chunk is cut. The reader of bags refuses
such a file, so it is given another view of it: everything up to the cut, the whole messages of the
cut chunk, and an end. Nothing is written.

Source: https://mcap.dev/spec
"""

import io
import struct
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

from hypernav.core.components.registry import require

_MAGIC = b"\x89MCAP0\r\n"
_FOOTER, _CHUNK, _DATA_END = 2, 6, 15
_RECORD = struct.Struct("<BQ")
"""Kind and length of a record, before its content."""
_MOST_CHUNK = 1 << 30
_CHUNK_TIMES = struct.Struct("<QQ")
_CHUNK_SIZES = struct.Struct("<QI")
"""Uncompressed size and checksum."""


@dataclass(frozen=True)
class ClosedView:
    """A file that goes on differently from some byte on, for readers that take path-like objects.

    Attributes:
        path: The file.
        cut: Number of bytes that are taken from it.
        end: The bytes after them.
    """

    path: Path
    cut: int
    end: bytes

    @property
    def suffix(self) -> str:
        """Suffix of the file."""
        return self.path.suffix

    def exists(self) -> bool:
        """Whether it is there."""
        return self.path.exists()

    def is_dir(self) -> bool:
        """No."""
        return False

    def open(self, mode: str) -> io.BufferedReader:
        """Open it to be read, the only mode."""
        return io.BufferedReader(_ClosedStream(self.path.open("rb"), self.cut, self.end))

    def __str__(self) -> str:
        """Path of the file."""
        return str(self.path)


class _ClosedStream(io.RawIOBase):
    def __init__(self, file: BinaryIO, cut: int, end: bytes) -> None:
        self._file, self._cut, self._end, self._at = file, cut, end, 0

    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def tell(self) -> int:
        return self._at

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        size = self._cut + len(self._end)
        self._at = offset + {io.SEEK_SET: 0, io.SEEK_CUR: self._at, io.SEEK_END: size}[whence]
        return self._at

    def readinto(self, buffer: Any) -> int:
        if self._at < self._cut:
            self._file.seek(self._at)
            data = self._file.read(min(len(buffer), self._cut - self._at))
        else:
            data = self._end[self._at - self._cut :][: len(buffer)]
        buffer[: len(data)] = data
        self._at += len(data)
        return len(data)

    def close(self) -> None:
        self._file.close()
        super().close()


def closed_view(path: Path) -> ClosedView | None:
    """What is whole in an MCAP file that was not closed; None for any other file.

    Raises:
        OSError: The file can't be read.
        MissingExtraError: The packages that unpack chunks are not installed.
    """
    size = path.stat().st_size
    with path.open("rb") as file:
        if file.read(len(_MAGIC)) != _MAGIC:
            return None
        file.seek(max(size - len(_MAGIC), 0))
        if file.read() == _MAGIC:
            return None
        cut, rest = _first_cut_record(file, size)
    end = _record(_DATA_END, bytes(4)) + _record(_FOOTER, bytes(20)) + _MAGIC
    return ClosedView(path, cut, _whole_part(rest) + end)


def _first_cut_record(file: BinaryIO, size: int) -> tuple[int, bytes]:
    """Where the first record begins that is not whole, and the bytes from there on."""
    at = len(_MAGIC)
    while at + _RECORD.size <= size:
        file.seek(at)
        kind, length = _RECORD.unpack(file.read(_RECORD.size))
        after = at + _RECORD.size + length
        if after > size or kind in (0, _FOOTER, _DATA_END):  # zeros are blocks never written
            file.seek(at)
            return at, file.read(_MOST_CHUNK) if kind == _CHUNK else b""
        at = after
    return at, b""


def _whole_part(cut_chunk: bytes) -> bytes:
    """A chunk of the whole records of one that is cut; nothing if there are none."""
    times = _RECORD.size + _CHUNK_TIMES.size
    head = times + _CHUNK_SIZES.size + 4
    if len(cut_chunk) < head:
        return b""
    (length,) = struct.unpack_from("<I", cut_chunk, head - 4)
    compression = cut_chunk[head : head + length].decode("ascii", "replace")
    records = _unpacked(cut_chunk[head + length + 8 :], compression)
    at = 0
    while at + _RECORD.size <= len(records):
        kind, length = _RECORD.unpack_from(records, at)
        if kind == 0 or at + _RECORD.size + length > len(records):
            break
        at += _RECORD.size + length
    sizes = _CHUNK_SIZES.pack(at, 0) + struct.pack("<I", 0) + struct.pack("<Q", at)
    return _record(_CHUNK, cut_chunk[_RECORD.size : times] + sizes + records[:at]) if at else b""


def _unpacked(data: bytes, compression: str) -> bytes:
    """As much as can be unpacked of data that is cut."""
    if compression == "lz4":
        lz4 = require("lz4.frame", extra="bags")
        unpack, broken = lz4.LZ4FrameDecompressor().decompress, RuntimeError
    elif compression == "zstd":
        name = "compression.zstd" if sys.version_info >= (3, 14) else "backports.zstd"
        zstd = require(name, extra="bags")
        unpack, broken = zstd.ZstdDecompressor().decompress, zstd.ZstdError
    else:
        return data if compression == "" else b""
    try:
        return unpack(data)
    except broken:
        return b""


def _record(kind: int, content: bytes) -> bytes:
    return _RECORD.pack(kind, len(content)) + content
