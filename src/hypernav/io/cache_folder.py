"""The cache folder, for data that saves time in later runs, and Numba's for compiled kernels.

Numba keeps kernels beside their source, or else in the user's cache, and ends the program where it
can keep them in neither: a package that an administrator installed, and a user without a home. They
are then kept in the cache of this package, or if that can't be written either, for one run alone.
"""

import logging
import os
import sys
from functools import cache
from pathlib import Path

CACHE_VARIABLE = "HYPERNAV_CACHE"
"""Environment variable that names another cache folder."""
_LOGGER = logging.getLogger(__name__)
_WARNED = set[Path]()

_NUMBA = "NUMBA_CACHE_DIR"
_FOR_ONE_RUN = "HYPERNAV_KERNELS_FOR_ONE_RUN"
"""Environment variable by which processes that this one starts know it, too."""
_PACKAGE = Path(__file__).parents[1]


def cache_folder() -> Path:
    """Cache folder: the one that `HYPERNAV_CACHE` names, or the platform's own.

    If it cannot be used, one warning says so; whoever reads or writes in it goes on without.
    """
    folder = named_cache_folder()
    _warn_if_unusable(folder)
    return folder


def named_cache_folder() -> Path:
    """The cache folder, whether it can be used or not."""
    if own := os.environ.get(CACHE_VARIABLE):
        return Path(own)
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Caches"
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return base / "hypernav"


@cache
def _warn_if_unusable(folder: Path) -> None:
    """Look at a folder once; one that is only missing is made when something is kept."""
    try:
        (folder / "anything").stat()
    except FileNotFoundError:
        pass
    except OSError as error:
        warn_unusable(folder, error)


def warn_unusable(folder: Path, error: OSError) -> None:
    """Say why nothing can be kept in a cache folder, unless that was said before."""
    if folder not in _WARNED:
        _WARNED.add(folder)
        _LOGGER.warning(
            "the cache %.80s cannot be used (%s), so buildings are made anew in every run; name a "
            "folder in %s",
            folder,
            error.strerror or error,
            CACHE_VARIABLE,
        )


def choose_kernel_folder(package: Path = _PACKAGE) -> None:
    """Name Numba a folder that can be written, unless it has one; before it is imported.

    Args:
        package: Folder of the package.
    """
    if os.environ.get(_NUMBA) or _can_be_written(package) or _can_be_written(_of_numba()):
        return
    own = named_cache_folder() / "kernels"
    if not _can_be_written(own):
        own = _temporary_folder()
        os.environ[_FOR_ONE_RUN] = str(own)
    os.environ[_NUMBA] = str(own)


def kernels_are_kept() -> bool:
    """Whether a later run finds what this one compiles."""
    return _FOR_ONE_RUN not in os.environ


def why_not_kept() -> str:
    """One line for people about kernels that can't be kept."""
    return (
        "compiling for this run alone, which takes a minute or more each time: neither "
        f"{_PACKAGE} nor {named_cache_folder()} can be written; name a folder that can be in "
        f"{CACHE_VARIABLE} …"
    )


def _temporary_folder() -> Path:
    """A folder that goes when this process ends."""
    import atexit
    import shutil
    import tempfile

    folder = Path(tempfile.mkdtemp(prefix="hypernav-kernels-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def _of_numba() -> Path:
    """The user's cache of Numba, as it names it."""
    if sys.platform in ("win32", "darwin"):
        return named_cache_folder().parent / "numba"
    base = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    return Path(base) / "numba"


def _can_be_written(folder: Path) -> bool:
    """Whether files can be made in a folder, which may still have to be made itself."""
    there = next(one for one in (folder, *folder.parents) if os.path.lexists(one))
    return os.path.isdir(there) and os.access(there, os.W_OK | os.X_OK)
