"""How a command ends: exit statuses, and unexpected errors with a line for people and a file.

Every command imports this module, so what only a crash needs is imported when one happens.
"""

import errno
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from enum import IntEnum
from pathlib import Path

from hypernav.core.errors import ComponentError, CrashError, HyPerNavError, OutputError
from hypernav.core.interruptions import interruptions_of_kernels
from hypernav.io.writing import lacks_room, write_whole


class ExitStatus(IntEnum):
    """How a command ended, for whoever started it."""

    SUCCESS = 0
    """The goal was found; the evaluation is complete; nothing is wrong with the model."""
    FAILURE = 1
    """The goal was not found; the model has a fault."""
    USAGE = 2
    """An option, a file or another input cannot be used, or a result cannot be written.

    Also used for an evaluation without any scored episode, and for a robot that doesn't stand
    still at the end.
    """
    MODEL_UNAVAILABLE = 3
    """A model was unavailable for longer than the patience."""
    CRASH = 70
    """An error of this program, or of a component of the user's own, which its message names."""
    INTERRUPTED = 130
    """Ctrl-C (SIGINT) ended the command."""
    TERMINATED = 143
    """SIGTERM ended the command, or SIGHUP: its terminal is gone."""


CRASH_FILE = "crash.txt"
_NO_MEMORY = re.compile(
    r"failed to map segment from shared object(?!: Operation not permitted)"
    "|[Cc]annot allocate memory|can't start new thread|Insufficient memory"
)
"""What the loader of shared libraries, Python and OpenCV say where the system refuses memory."""


class ReportedCrashError(HyPerNavError):
    """An error of this program whose traceback has been written to a file."""


class OutOfMemoryError(HyPerNavError):
    """The memory that this process may take is used up."""


@contextmanager
def crash_report(folder: Path | None = None) -> Iterator[None]:
    """Write the traceback of an unexpected error in the block to a file.

    Args:
        folder: Folder of the file ``crash.txt``; if it cannot be written, or for None, a
            temporary file is used.

    Raises:
        ReportedCrashError: The block raised an unexpected error, or a component of a user's own
            failed; the message names the file.
        OutOfMemoryError: The block needs more memory than there is.
        OutputError: There is no room for a file, for example of compiled kernels.
    """
    try:
        with interruptions_of_kernels():
            yield
    except CrashError as error:
        raise ReportedCrashError(_told(str(error), error.details, folder)) from error
    except ComponentError as error:
        written = f"; {_write(_page(error.details), folder)}" if error.details else ""
        raise ReportedCrashError(f"{_line(str(error))}{written}") from error
    except HyPerNavError:
        raise
    except Exception as error:  # The only broad except: what else it catches is a bug of ours.
        if _lacks_memory(error):
            raise OutOfMemoryError(
                f"out of memory{f' ({_line(str(error))})' if str(error) else ''}; close other "
                "programs, raise the limits (ulimit -v and -u, the container's), or take a smaller "
                "building or camera"
            ) from None
        if isinstance(error, OSError) and (remedy := lacks_room(error)):
            what = _line(str(error))  # a file of ours says which; a library's cache does not
            raise OutputError(f"a file cannot be written ({what}); {remedy}") from None
        import traceback

        last = traceback.format_exception_only(error)[-1].strip()
        raise ReportedCrashError(_told(last, traceback.format_exc(), folder)) from error


def _lacks_memory(error: BaseException | None) -> bool:
    """Whether an error or one that led to it says that there is no memory, as for a library."""
    seen = list[BaseException]()
    while error is not None and all(error is not one for one in seen):
        is_refused = isinstance(error, OSError) and error.errno == errno.ENOMEM
        if isinstance(error, MemoryError) or is_refused or _NO_MEMORY.search(str(error)):
            return True
        seen.append(error)
        error = error.__cause__
    return False


def _told(what: str, details: str, folder: Path | None) -> str:
    """Write the details of a crash to a file; returns the message for people."""
    written = _write(_page(details), folder)
    return f"this should not have happened: {_line(what)}; please report it, {written}"


def _line(what: str) -> str:
    line = " ".join(what.split())
    return line if len(line) <= 400 else f"{line[:400]} …"


def _page(details: str) -> str:
    import platform
    from importlib.metadata import version

    return (
        f"hypernav {version('hypernav')}, Python {platform.python_version()}, "
        f"{platform.platform()}\n{sys.argv!r}\n\n{details}"
    )


def _write(page: str, folder: Path | None) -> str:
    """Write a crash's details; returns a sentence that says where they are."""
    import tempfile

    data = page.encode(errors="backslashreplace")
    if folder is not None:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            write_whole(folder / CRASH_FILE, data)
        except OSError:
            pass
        else:
            return f"the traceback is in {folder / CRASH_FILE}"
    try:
        with tempfile.NamedTemporaryFile(
            prefix="hypernav-crash-", suffix=".txt", delete=False
        ) as file:
            file.write(data)
    except OSError as error:
        return f"the traceback could not be written anywhere ({error.strerror})"
    return f"the traceback is in {file.name}"
