"""A bag as topics and messages, for all formats; damage raises typed errors."""

import struct
from collections import defaultdict
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from hypernav.core.components.registry import require
from hypernav.core.errors import RecordingError, RosMessageError, TransformMissingError
from hypernav.robot.recordings.unclosed import ClosedView, closed_view

_BROKEN = (
    *(AssertionError, EOFError, LookupError, MemoryError, OSError, OverflowError),
    *(RosMessageError, TransformMissingError, ValueError, struct.error),
    *(AttributeError, TypeError),  # the bag defines a type in another way
)
"""What damaged bytes raise in the bag reader besides its own errors: it does not check them."""


STORAGES = (".mcap", ".db3")
"""Suffixes of the files of ROS 2."""
_MEND = {
    ".bag": "rosbag reindex {path}",
    ".db3": "sqlite3 {path} .recover | sqlite3 mended.db3",
}
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

        Args:
            remedy: What to do, as the end of the sentence.

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
