"""A folder that may come from a stranger: what lies below it is opened from its descriptor.

Memories and runs are shared, as maps are. The folder itself may be named by a link. Below it no
link is followed, whatever is swapped meanwhile: only regular files of its own are read, written and
removed.
"""

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from hypernav.io.reading import MOST_BYTES, content_of, kind_of

_FOLDER = os.O_RDONLY | os.O_DIRECTORY
_BELOW = os.O_NOFOLLOW | os.O_NONBLOCK  # a pipe without a writer would block


class NotOwnError(OSError):
    """What has a name in a folder is a link, a pipe, a device or a socket."""


class ForeignFolder:
    """A folder, open until it is closed. Names are relative paths with ``/`` between their parts.

    All methods raise `NotOwnError` for what is neither a regular file nor a folder, and another
    `OSError` for names that lead out of the folder and for what the system refuses.

    Attributes:
        path: Its path, as it was given.
    """

    def __init__(self, path: Path) -> None:
        """Open the folder.

        Raises:
            OSError: There is none, or it can't be opened.
        """
        self.path = path
        self._descriptor = os.open(path, _FOLDER)

    def __enter__(self) -> "ForeignFolder":
        """The open folder."""
        return self

    def __exit__(self, *error: object) -> None:
        """Close it; whatever gets its descriptor next is not taken for it."""
        os.close(self._descriptor)
        self._descriptor = -1

    def is_in_place(self) -> bool:
        """Whether its path still leads to it, so that it was neither moved nor removed."""
        try:
            return os.path.samestat(os.stat(self.path), os.fstat(self._descriptor))
        except OSError:
            return False

    def holds(self, name: str) -> bool:
        """Whether something of this name is there, of whatever kind."""
        try:
            with self._parent(name) as (parent, last):
                os.stat(last, dir_fd=parent, follow_symlinks=False)
        except FileNotFoundError:
            return False
        return True

    def read(self, name: str, *, most: int = MOST_BYTES) -> bytes:
        """The content of a file.

        Args:
            name: The file.
            most: Largest size that is read, bytes; a larger file is refused (``EFBIG``).
        """
        with open(self.descriptor_of(name, os.O_RDONLY), "rb") as file:
            return content_of(file, most=most)

    def write(self, name: str, content: str | bytes, *, sync: bool = True) -> None:
        """Replace a file in one step. If that fails, it is unchanged.

        The content goes to a new file ``.NAME.new`` first; one that was left behind is removed.

        Args:
            name: The file.
            content: Its new content; text is written as UTF-8.
            sync: Whether to wait for the disk, so that a loss of power leaves no empty file.
        """
        with self._parent(name) as (parent, last):
            fresh = f".{last}.new"
            descriptor = _made(fresh, parent)
            try:
                with open(descriptor, "wb") as file:
                    file.write(content.encode() if isinstance(content, str) else content)
                    file.flush()
                    if sync:
                        os.fsync(descriptor)
                os.replace(fresh, last, src_dir_fd=parent, dst_dir_fd=parent)
            except BaseException:
                with suppress(OSError):  # the folder may be gone, too
                    os.unlink(fresh, dir_fd=parent)
                raise

    def descriptor_of(self, name: str, flags: int, mode: int = 0o666) -> int:
        """A descriptor of a regular file, which the caller closes.

        Args:
            name: The file.
            flags: How it is opened, as for `os.open`.
            mode: Permissions of a new file.
        """
        with self._parent(name) as (parent, last):
            descriptor = _opened(last, flags, parent, mode)
            try:
                _check_own(last, os.fstat(descriptor))
            except OSError:
                os.close(descriptor)
                raise
            return descriptor

    def make_folder(self, name: str) -> None:
        """Make a folder, unless it is there."""
        with self._parent(name) as (parent, last):
            try:
                os.mkdir(last, dir_fd=parent)
            except FileExistsError:
                os.close(_opened(last, _FOLDER, parent))

    def listing(self, name: str = "") -> dict[str, bool]:
        """What is in a folder: names, and whether each is a folder.

        Args:
            name: The folder; empty for this one itself.
        """
        entries = dict[str, bool]()
        with self._parent(f"{name}/." if name else ".") as (parent, _), os.scandir(parent) as found:
            for one in found:
                entries[one.name] = one.is_dir(follow_symlinks=False)
                if not (entries[one.name] or one.is_file(follow_symlinks=False)):
                    _check_own(one.name, one.stat(follow_symlinks=False))
        return entries

    def rename(self, name: str, last: str) -> None:
        """Give a file another last part of its name; what had that name is replaced."""
        with self._parent(name) as (parent, old):
            os.replace(old, last, src_dir_fd=parent, dst_dir_fd=parent)

    def remove(self, name: str) -> None:
        """Remove a file."""
        with self._parent(name) as (parent, last):
            os.unlink(last, dir_fd=parent)

    @contextmanager
    def _parent(self, name: str) -> Iterator[tuple[int, str]]:
        """Descriptor of the folder that holds a file, and the last part of the file's name."""
        *folders, last = name.split("/")
        if last in ("", "..") or not {"", ".", ".."}.isdisjoint(folders):
            raise OSError(errno.EPERM, "its name leads out of the folder", name)
        descriptor = self._descriptor
        try:
            for folder in folders:
                inner = _opened(folder, _FOLDER, descriptor)
                if descriptor != self._descriptor:
                    os.close(descriptor)
                descriptor = inner
            yield descriptor, last
        finally:
            if descriptor != self._descriptor:
                os.close(descriptor)


def read_own(path: Path, *, most: int = MOST_BYTES) -> bytes:
    """The content of a regular file that is its folder's own.

    Args:
        path: The file.
        most: Largest size that is read, bytes.

    Raises:
        OSError: It can't be read; a `NotOwnError` for a link, a pipe, a device or a socket.
    """
    with ForeignFolder(path.parent) as folder:
        return folder.read(path.name, most=most)


def _opened(name: str, flags: int, parent: int, mode: int = 0o666) -> int:
    """A descriptor of what is in a folder, which is no link."""
    try:
        return os.open(name, flags | _BELOW, mode, dir_fd=parent)
    except OSError as error:
        # Systems differ in the error for a link, and for a socket.
        if error.errno in (errno.ELOOP, errno.EMLINK, errno.ENOTDIR, errno.ENXIO):
            _check_own(name, os.stat(name, dir_fd=parent, follow_symlinks=False))
        raise


def _made(name: str, parent: int) -> int:
    """A descriptor of a new file, in place of a regular one that was left behind."""
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL
    try:
        return _opened(name, flags, parent)
    except FileExistsError:
        _check_own(name, os.stat(name, dir_fd=parent, follow_symlinks=False))
    os.unlink(name, dir_fd=parent)
    return _opened(name, flags, parent)


def _check_own(name: str, status: os.stat_result) -> None:
    if (kind := kind_of(status)) is not None:
        raise NotOwnError(kind[0], f"{name} is {kind[1]}, expected a file or folder of its own")
