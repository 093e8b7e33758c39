"""What libraries say: no command shows it, because errors and warnings say in words what matters.

A library logs to where nobody listens, which Python prints, or warns; a reader of the command line
would take its lines for ours, before the one that counts.
"""

import logging
import os
import sys
import sysconfig
import warnings
from pathlib import Path
from typing import Any

_LIBRARIES = tuple(
    f"{folder}{os.sep}"
    for folder in {
        *(sysconfig.get_path(kind) for kind in ("stdlib", "purelib", "platlib")),
        str(Path(__file__).parents[2]),
    }
)
"""Folders of Python, of installed packages and of this one, where their warnings are placed."""


def silence_libraries() -> None:
    """Print nothing more that libraries log or warn of; code of a user's own is heard as before.

    Python's options ``-W`` and ``PYTHONWARNINGS`` bring back the warnings.
    """
    if logging.lastResort is not None:
        logging.lastResort.addFilter(lambda record: not _is_library(record.pathname))
    os.environ.setdefault("OPENCV_LOG_LEVEL", "SILENT")
    if sys.warnoptions:
        return
    show = warnings.showwarning

    def shown(message: Any, category: Any, filename: str, *more: Any, **named: Any) -> None:
        if not _is_library(filename):
            show(message, category, filename, *more, **named)

    warnings.showwarning = shown


def _is_library(file: str) -> bool:
    return file.startswith(_LIBRARIES)
