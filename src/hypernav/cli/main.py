"""The `hypernav` command: its start, and its exit status in all cases.

Signal handlers are installed first and everything else is imported after that, so that Ctrl-C in
the first second ends the program as it does later.
"""

import os
import re
import sys
from collections.abc import Sequence
from contextlib import suppress
from typing import NoReturn

from hypernav.cli.guards.crashes import ReportedCrashError, crash_report
from hypernav.cli.guards.interruptions import Terminated, sigterm_as_interruption
from hypernav.cli.guards.statuses import ExitStatus
from hypernav.core.errors import HyPerNavError, ModelUnavailableError
from hypernav.core.text.visible_text import visible

_LONG_WORD = re.compile(r"\S{300,}")


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run a command and exit with its status, see `ExitStatus`."""
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:  # closed: no file of a search may get its number
            setattr(sys, name, open(os.devnull, "w"))  # noqa: SIM115
    sys.exit(_flushed(_status(sys.argv[1:] if arguments is None else arguments)))


def _status(arguments: Sequence[str]) -> int:
    try:
        with sigterm_as_interruption(), crash_report():
            from hypernav.cli.command_line import run_command

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


def _flushed(status: int) -> int:
    """The status, or that of unwritable output, for which Python itself would return 120."""
    try:
        if sys.stdout is not None:
            sys.stdout.flush()
    except OSError as error:
        sys.stdout = None  # so that Python does not flush it again at its end
        return _say(f"standard output cannot be written ({error.strerror})", ExitStatus.USAGE)
    return status


def _say(message: str, status: ExitStatus) -> ExitStatus:
    """Print a message; very long words are shortened."""
    text = _LONG_WORD.sub(lambda word: f"{word[0][:80]}…{word[0][-40:]}", message)
    with suppress(OSError):  # a lost terminal does not change the status
        print(f"hypernav: {visible(text)}", file=sys.stderr)
    return status
