"""The `hypernav` command: its start, and its exit status in all cases.

Signal handlers are installed first and everything else is imported after that, so that Ctrl-C in
the first second ends the program as it does later.
"""

import logging
import os
import re
import sys
import sysconfig
import threading
import time
import warnings
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, NoReturn

from hypernav.app.cli.guards.crashes import ExitStatus, ReportedCrashError, crash_report
from hypernav.app.cli.guards.interruptions import Terminated, sigterm_as_interruption
from hypernav.core.errors import HyPerNavError, ModelUnavailableError
from hypernav.core.naming.words import visible

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


_LINGER_S = 5.0
"""Time that threads of components have to end after the command has."""
_LONG_WORD = re.compile(r"\S{300,}")


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run a command and exit with its status, see `ExitStatus`."""
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:  # closed: no file of a search may get its number
            setattr(sys, name, open(os.devnull, "w"))  # noqa: SIM115
    if arguments is None:  # this is the program
        silence_libraries()
    status = _flushed(_status(sys.argv[1:] if arguments is None else arguments))
    if arguments is None:  # this is the program
        _end_without_threads(status)
    sys.exit(status)


def _status(arguments: Sequence[str]) -> int:
    try:
        with sigterm_as_interruption(), crash_report():
            from hypernav.app.cli.command_line import run_command

            return run_command(arguments)
    except Terminated:
        return _say("terminated", ExitStatus.TERMINATED)
    except KeyboardInterrupt:
        return _say("interrupted", ExitStatus.INTERRUPTED)
    except ReportedCrashError as error:
        return _say(str(error), ExitStatus.CRASH)
    except ModelUnavailableError as error:
        return _say(str(error), ExitStatus.MODEL_UNAVAILABLE)
    except HyPerNavError as error:
        return _say(str(error), ExitStatus.USAGE)


def _end_without_threads(status: int) -> None:
    """Let the process end although a component has left a thread running."""

    def end() -> None:
        time.sleep(_LINGER_S)
        names = ", ".join(thread.name for thread in left if thread.is_alive())
        if names:
            _say(f"ended although a component has left a thread running: {names}", status)
            os._exit(status)

    left = [one for one in threading.enumerate() if not one.daemon]
    left.remove(threading.main_thread())
    if left:
        threading.Thread(target=end, daemon=True).start()


def _flushed(status: int) -> int:
    """The status, or that of unwritable output, for which Python itself would return 120."""
    try:
        if sys.stdout is not None:
            sys.stdout.flush()
    except OSError as error:
        sys.stdout = None  # so that Python does not flush it again at its end
        return _say(f"standard output cannot be written ({error.strerror})", ExitStatus.USAGE)
    return status


def _say(message: str, status: int) -> int:
    """Print a message as one line; very long words are shortened."""
    line = " ".join(message.split())
    text = _LONG_WORD.sub(lambda word: f"{word[0][:80]}…{word[0][-40:]}", line)
    with suppress(OSError):  # a lost terminal does not change the status
        print(f"hypernav: {visible(text)}", file=sys.stderr)
    return status
