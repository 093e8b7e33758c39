"""A bag as topics and messages, for all formats; damage raises typed errors."""

import struct
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from hypernav.core.components.extras import require
from hypernav.core.errors import RecordingError, RosMessageError, TransformMissingError

_BROKEN = (
    *(AssertionError, EOFError, LookupError, MemoryError, OSError, OverflowError),
    *(RosMessageError, TransformMissingError, ValueError, struct.error),
    *(AttributeError, TypeError),  # the bag defines a type in another way
)
"""What damaged bytes raise in the bag reader besides its own errors: it does not check them."""


class BagFile:
    """An open bag.

    Attributes:
        path: Path of the bag.
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
        self._broken = (*_BROKEN, highlevel.AnyReaderError, *_errors())
        self._stack = ExitStack()
        # Older bags of ROS 2 don't say what their types are.
        store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
        with self.checked():
            reader = highlevel.AnyReader([path], default_typestore=store)
            self._reader = self._stack.enter_context(reader)
            self._connections = {one.topic: one for one in reader.connections if one.msgcount}

    def __enter__(self) -> "BagFile":
        """The bag itself."""
        return self

    def __exit__(self, *error: object) -> None:
        """Close the bag."""
        self._stack.close()

    @contextmanager
    def checked(self) -> Iterator[None]:
        """Turn every error that damaged bytes can raise into one.

        Raises:
            RecordingError: The block failed because the bag is damaged.
        """
        try:
            yield
        except self._broken as error:
            said = str(error) or type(error).__name__
            raise RecordingError(f"{self.path} can't be read: {said:.300}") from error

    def topics(self, *types: str) -> list[str]:
        """The topics with messages of given types."""
        return sorted(
            name for name, connection in self._connections.items() if connection.msgtype in types
        )

    def first(self, topic: str) -> Any:
        """The first message of a topic.

        Raises:
            RecordingError: The message is broken.
        """
        for _, message in self.messages(topic):
            return message
        raise RecordingError(f"{self.path}: {topic} holds fewer messages than announced")

    def messages(self, topic: str) -> Iterator[tuple[int, Any]]:
        """All messages of a topic, each with its key for `message`.

        Raises:
            RecordingError: A message is broken.
        """
        with self.checked():
            for _, at, data in self._reader.messages([self._connections[topic]]):
                yield at, self._read(topic, data)

    def message(self, topic: str, at: int) -> Any:
        """One message.

        Raises:
            RecordingError: It is broken.
        """
        found = self._reader.messages([self._connections[topic]], start=at, stop=at + 1)
        with self.checked():
            for _, _, data in found:
                return self._read(topic, data)
        raise RecordingError(f"{self.path}: cannot find a message of {topic} again")

    def _read(self, topic: str, data: bytes) -> Any:
        return self._reader.deserialize(data, self._connections[topic].msgtype)


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
