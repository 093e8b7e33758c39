"""Writes files: replaced in one step, in complete pieces, or as a search goes on."""

import errno
import io
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TextIO

from hypernav.core.errors import OutputError
from hypernav.io.foreign_folder import ForeignFolder, NotOwnError


def lacks_room(error: OSError) -> str:
    """What helps where an error says that there is no room for a file; empty if it does not."""
    if error.errno == errno.EFBIG:
        return "raise the limit of a file's size (ulimit -f)"
    return "free some space" if error.errno in (errno.ENOSPC, errno.EDQUOT) else ""


def write_whole(path: Path, content: str | bytes) -> None:
    """Replace a file in one step, and wait for the disk. If that fails, the file is unchanged.

    Args:
        path: The file.
        content: Its new content; text is written as UTF-8.

    Raises:
        OSError: The disk is full, or the file can't be written.
    """
    with ForeignFolder(path.parent) as folder:
        folder.write(path.name, content)


@contextmanager
def csv_file(path: Path) -> Iterator[TextIO]:
    """A table to be filled, which then replaces a file, as `write_whole` does."""
    file = io.StringIO(newline="")
    yield file
    write_whole(path, file.getvalue())


def own_descriptor(path: Path, how: int = 0, mode: int = 0o666) -> int:
    """A descriptor of a file to write in place, which is made if missing.

    Args:
        path: The file.
        how: More flags, as for `os.open`.
        mode: Permissions of a new file.

    Raises:
        OSError: It can't be opened; a `NotOwnError` if it is not only its folder's own.
    """
    with ForeignFolder(path.parent) as folder:
        descriptor = folder.descriptor_of(path.name, os.O_RDWR | os.O_CREAT | how, mode)
    if os.fstat(descriptor).st_nlink > 1:
        os.close(descriptor)
        raise NotOwnError(errno.EMLINK, f"{path.name} is also a file elsewhere (a hard link)")
    return descriptor


def own_folder(home: Path, *names: str) -> Path:
    """A folder below another, which may be a stranger's; it is made if missing.

    Args:
        home: The other folder.
        names: Names of the folders on the way, the wanted one last.

    Raises:
        OutputError: It can't be made, or one on the way is no folder but a link.
    """
    path = home.joinpath(*names)
    try:
        with ForeignFolder(home) as folder:
            for count in range(1, len(names) + 1):
                folder.make_folder("/".join(names[:count]))
    except OSError as error:
        raise _unwritten(path, error) from error
    return path


class AppendOnlyFile:
    """Appends bytes completely or not at all, and passes them to the operating system at once.

    Only a file of the folder's own is written in place, with no other name: its folder may be a
    stranger's. Not thread-safe. A process that is killed may leave an incomplete last piece.

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
        if to_read:
            with ForeignFolder(path.parent) as folder:
                descriptor = folder.descriptor_of(path.name, os.O_RDONLY)
        else:
            descriptor = own_descriptor(path, os.O_APPEND, mode)
        self._file = open(descriptor, "rb" if to_read else "a+b", 0)  # noqa: SIM115
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


def check_regular(path: Path) -> None:
    """Refuse what is no regular file, such as a pipe, which nobody may ever read.

    A link to a file that is not there yet will do where that file can be made.

    Raises:
        OutputError: It is something else, its name is impossible, or it is a link to nowhere.
    """
    try:
        mode = path.stat().st_mode
    except FileNotFoundError:
        target = path.resolve() if path.is_symlink() else None
        if target is not None and not target.parent.is_dir():
            raise OutputError(
                f"{path} cannot be written (it is a link to {target}, and there is no folder "
                f"{target.parent}); remove it, or choose another file"
            ) from None
        return
    except OSError as error:
        raise _unwritten(path, error) from error
    if stat.S_ISDIR(mode):
        raise OutputError(f"{path} is a folder where a file would be; choose another name")
    if not stat.S_ISREG(mode):
        raise OutputError(
            f"{path} is a pipe or a device where a file would be; choose another name"
        )


class OutputFile:
    """An open file that discards what is written after an error, for libraries that print errors.

    Attributes:
        path: Its path.
    """

    def __init__(self, path: Path) -> None:
        """Open the file; an existing one is replaced, missing folders are created.

        Raises:
            OutputError: It cannot be written.
        """
        check_regular(path)
        self.path = path
        self._error: OSError | None = None
        self._at = self._end = 0
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = path.open("wb", buffering=0)
        except OSError as error:
            raise _unwritten(path, error) from error

    def write(self, data: bytes | bytearray) -> int:
        """Write bytes, unless an earlier write failed."""
        view = memoryview(data)
        try:
            while view and self._error is None:
                view = view[self._file.write(view) :]
        except OSError as error:
            self._error = error
        self._at += len(data)
        self._end = max(self._end, self._at)
        return len(data)

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Move to another position; returns it. After an error it is that of a file without one."""
        self._at = offset + {os.SEEK_SET: 0, os.SEEK_CUR: self._at, os.SEEK_END: self._end}[whence]
        if self._error is None:
            self._file.seek(self._at)
        return self._at

    def flush(self) -> None:
        """Do nothing: all bytes are with the operating system already."""

    def close(self) -> None:
        """Close the file."""
        with suppress(OSError):
            self._file.close()

    def check(self) -> None:
        """Raise the first error of writing.

        Raises:
            OutputError: Something could not be written.
        """
        if self._error is not None:
            raise _unwritten(self.path, self._error)


def _unwritten(path: Path, error: OSError) -> OutputError:
    if error.errno == errno.ELOOP and not isinstance(error, NotOwnError):
        return OutputError(
            f"{path} cannot be written (links on the way lead in a circle); remove them, or choose "
            "another file"
        )
    return OutputError(
        f"{path} cannot be written ({error.strerror}); free some space, or choose another file"
    )
