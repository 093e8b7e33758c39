"""The cache folder, for data that saves time in later runs."""

import logging
import os
import sys
from functools import cache
from pathlib import Path

CACHE_VARIABLE = "HYPERNAV_CACHE"
"""Environment variable that names another cache folder."""
_LOGGER = logging.getLogger(__name__)


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
        _LOGGER.warning(
            "the cache %.80s cannot be used (%s), so buildings are made anew in every run; name a "
            "folder in %s",
            folder,
            error.strerror,
            CACHE_VARIABLE,
        )
