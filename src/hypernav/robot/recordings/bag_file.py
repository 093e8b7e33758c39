"""A bag as topics and messages, for all formats; damage raises typed errors.

An MCAP file whose recorder lost power has no footer, and its last chunk is cut. The package that
reads bags refuses such a file, so it is given another view of it: everything up to the cut, the
whole messages of the cut chunk, and an end. Nothing is written.

Source: https://mcap.dev/spec
"""

import io
import struct
import sys
from collections import defaultdict
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

from hypernav.core.components.registry import require
from hypernav.core.errors import RecordingError, RosMessageError, TransformMissingError

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


_BROKEN = (
    *(AssertionError, EOFError, LookupError, MemoryError, OSError, OverflowError),
    *(RosMessageError, TransformMissingError, ValueError, struct.error),
    *(AttributeError, TypeError),  # the bag defines a type in another way
)
"""What damaged bytes raise in the bag reader besides its own errors: it does not check them."""


STORAGES = (".mcap", ".db3")
"""Suffixes of the files of ROS 2."""
_MEND = {".bag": "rosbag reindex {path}", ".db3": "sqlite3 {path} .recover | sqlite3 mended.db3"}
"""The command that mends what was not closed, where it can't be read as it is."""

MessageKey = tuple[int, int]
"""Time of a message in the bag, nanoseconds, and its number among those of that time."""


class BagFile:
    """An open bag.

    Attributes:
        path: Path of the bag.
        notes: What its reader should know, one sentence each.
    """

    def __init__(self, path: Path) -> None:
        """Open a bag.

        Raises:
            RecordingError: The file is no bag, or is damaged.
            MissingExtraError: The package that reads bags is not installed.
        """
        highlevel = require("rosbags.highlevel", extra="bags")
        typesys = require("rosbags.typesys", extra="bags")
        self.path = path
        self.notes: list[str] = []
        self._broken = (*_BROKEN, highlevel.AnyReaderError, *_errors())
        self._stack = ExitStack()
        # Older bags of ROS 2 don't say what their types are.
        store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
        self._connections: dict[str, list[Any]] = defaultdict(list)
        with self.checked(_remedy(path)):
            paths = self._readable_paths()
            reader = highlevel.AnyReader(paths, default_typestore=store)
            self._reader = self._stack.enter_context(reader)
            # Every publisher of a topic has a connection of its own.
            for connection in reader.connections:
                if connection.msgcount:
                    self._connections[connection.topic].append(connection)

    def _readable_paths(self) -> list[Path | ClosedView]:
        """The bag, or its files as far as they can be read, if it was not closed."""
        if not self.path.is_dir():
            view = closed_view(self.path)
            if view is not None:
                self.notes.append(f"{self.path} was not closed, and is read up to its end")
            return [view or self.path]
        files = sorted(file for file in self.path.iterdir() if file.suffix in STORAGES)
        views = [closed_view(file) for file in files]
        metadata = self.path / "metadata.yaml"
        # A loss of power may leave an empty file.
        if metadata.is_file() and metadata.stat().st_size and not any(views):
            return [self.path]
        packed = sorted(self.path.glob("*.zstd"))
        if packed:
            raise OSError(f"it has no usable metadata.yaml; unpack its files: zstd -d {packed[0]}")
        self.notes.append(f"{self.path} was not closed, and is read up to its end")
        return [view or file for view, file in zip(views, files, strict=True)]

    def __enter__(self) -> "BagFile":
        """The bag itself."""
        return self

    def __exit__(self, *error: object) -> None:
        """Close the bag."""
        self._stack.close()

    @contextmanager
    def checked(self, remedy: str = "") -> Iterator[None]:
        """Turn every error that damaged bytes can raise into one.

        Raises:
            RecordingError: The block failed because the bag is damaged.
        """
        try:
            yield
        except self._broken as error:
            said = str(error) or type(error).__name__
            raise RecordingError(f"{self.path} can't be read: {said:.300}{remedy}") from error

    def topics(self, *types: str) -> list[str]:
        """The topics with messages of given types."""
        return sorted(
            name
            for name, connections in self._connections.items()
            if any(connection.msgtype in types for connection in connections)
        )

    def first(self, topic: str) -> Any:
        """The first message of a topic.

        Raises:
            RecordingError: The message is broken.
        """
        for _, message in self.messages(topic):
            return message
        raise RecordingError(f"{self.path}: {topic} holds fewer messages than announced")

    def messages(self, topic: str) -> Iterator[tuple[MessageKey, Any]]:
        """All messages of a topic, each with its key for `message`.

        Raises:
            RecordingError: A message is broken.
        """
        yield from self._found(topic)

    def message(self, topic: str, key: MessageKey) -> Any:
        """One message.

        Raises:
            RecordingError: It is broken.
        """
        for found, message in self._found(topic, start=key[0], stop=key[0] + 1):
            if found == key:
                return message
        raise RecordingError(f"{self.path}: cannot find a message of {topic} again")

    def _found(self, topic: str, **times: int) -> Iterator[tuple[MessageKey, Any]]:
        before, number = -1, 0
        with self.checked():
            for connection, at, data in self._reader.messages(self._connections[topic], **times):
                number = number + 1 if at == before else 0
                before = at
                yield (at, number), self._reader.deserialize(data, connection.msgtype)


def _remedy(path: Path) -> str:
    kind = ".bag" if path.suffix == ".active" else path.suffix
    command = _MEND.get(kind, "").format(path=path)
    return f"; if it was not closed, mend it: {command}" if command else ""


def _errors() -> tuple[type[Exception], ...]:
    """The errors of the libraries that the bag reader uses."""
    names = (
        ("rosbags.rosbag1", "ReaderError"),
        ("rosbags.rosbag2", "ReaderError"),
        ("rosbags.serde", "SerdeError"),
        ("rosbags.typesys", "TypesysError"),
        ("apsw", "Error"),
        ("ruamel.yaml.error", "YAMLError"),
    )
    return tuple(getattr(require(module, extra="bags"), name) for module, name in names)
