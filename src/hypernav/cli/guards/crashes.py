"""Errors that nobody expected: a line for people, and a file with the traceback.

What only a crash needs is imported then: every command is loaded through this module.
"""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from hypernav.core.errors import CrashError, HyPerNavError
from hypernav.core.interruptions import interruptions_of_kernels

CRASH_FILE = "crash.txt"


class ReportedCrashError(HyPerNavError):
    """An error of this program whose traceback has been written to a file."""


@contextmanager
def crash_report(folder: Path | None = None) -> Iterator[None]:
    """Write the traceback of an error that nobody expected in the block to a file.

    Args:
        folder: Folder of the file ``crash.txt``; where it cannot be written, and for None, a
            temporary file takes its place.

    Raises:
        ReportedCrashError: The block failed that way; the message names the file.
    """
    try:
        with interruptions_of_kernels():
            yield
    except CrashError as error:
        raise ReportedCrashError(_told(str(error), error.details, folder)) from error
    except HyPerNavError:
        raise
    except Exception as error:  # This alone is broad: whatever it catches is our fault.
        import traceback

        last = traceback.format_exception_only(error)[-1].strip()
        raise ReportedCrashError(_told(last, traceback.format_exc(), folder)) from error


def _told(what: str, details: str, folder: Path | None) -> str:
    """The message about a crash, after writing down its details."""
    line = " ".join(what.split())
    line = line if len(line) <= 300 else f"{line[:300]} …"
    return f"this should not have happened: {line}; {_write(_page(details), folder)}"


def _page(details: str) -> str:
    import platform
    from importlib.metadata import version

    return (
        f"hypernav {version('hypernav')}, Python {platform.python_version()}, "
        f"{platform.platform()}\n{sys.argv!r}\n\n{details}"
    )


def _write(page: str, folder: Path | None) -> str:
    """Write a crash's page; where it is, in words."""
    import tempfile

    data = page.encode(errors="backslashreplace")
    if folder is not None:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            (folder / CRASH_FILE).write_bytes(data)
        except OSError:
            pass
        else:
            return f"please report it with the traceback in {folder / CRASH_FILE}"
    try:
        with tempfile.NamedTemporaryFile(
            prefix="hypernav-crash-", suffix=".txt", delete=False
        ) as file:
            file.write(data)
    except OSError as error:
        return f"the traceback could not be written anywhere ({error.strerror})"
    return f"please report it with the traceback in {file.name}"
