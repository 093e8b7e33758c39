"""A file that only grows, by complete pieces."""

import os
from pathlib import Path


class AppendOnlyFile:
    """Appends bytes completely or not at all, and passes them to the operating system at once.

    Not thread-safe. A process that is killed may leave an incomplete last piece.

    Attributes:
        size: Number of bytes.
    """

    def __init__(self, path: Path, *, mode: int = 0o644, to_read: bool = False) -> None:
        """Open or create the file, and continue at its end.

        Args:
            path: Path of the file.
            mode: Permissions of a new file.
            to_read: Whether to open it for reading only, since somebody else may be writing it.

        Raises:
            OSError: It cannot be opened.
        """
        how = "rb" if to_read else "a+b"
        self._file = open(  # noqa: SIM115  # closed by `close`
            path, how, 0, opener=lambda name, flags: os.open(name, flags, mode)
        )
        self.size = self._file.seek(0, os.SEEK_END)

    def append(self, data: bytes, *, sync: bool = False) -> None:
        """Write at the end.

        Args:
            data: The bytes.
            sync: Whether to wait until they, and all before them, are on the disk. Without that
                they survive a crash of this program, but not a loss of power.

        Raises:
            OSError: The disk is full, or the file can't be written. It is unchanged.
        """
        view = memoryview(data)
        try:
            while view:
                view = view[self._file.write(view) :]
            if sync:
                self.sync()
        except OSError:
            self._file.truncate(self.size)  # shrinking needs no free space
            raise
        self.size += len(data)

    def sync(self) -> None:
        """Wait until all bytes are on the disk.

        Raises:
            OSError: The disk fails.
        """
        os.fsync(self._file.fileno())

    def read(self, at: int, count: int) -> bytes:
        """Bytes from an offset on; fewer at the end of the file. Not on Windows."""
        return os.pread(self._file.fileno(), count, at)

    def cut(self, size: int) -> None:
        """Keep the first bytes only."""
        self._file.truncate(size)
        self.size = size

    def close(self) -> None:
        """Close the file."""
        self._file.close()
