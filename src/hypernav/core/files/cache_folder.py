"""The cache folder, for data that saves time in later runs."""

import os
import sys
from pathlib import Path

CACHE_VARIABLE = "HYPERNAV_CACHE"
"""Environment variable that names another cache folder."""


def cache_folder() -> Path:
    """Cache folder: the one that `HYPERNAV_CACHE` names, or the platform's own."""
    if own := os.environ.get(CACHE_VARIABLE):
        return Path(own)
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Caches"
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return base / "hypernav"
