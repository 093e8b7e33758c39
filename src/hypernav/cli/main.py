"""The `hypernav` command: how it begins, and how it ends whatever happens.

Signals are minded first. Everything else is imported after that, so that Ctrl-C in the first second
ends the program as it does later.
"""

import sys
from collections.abc import Sequence
from typing import NoReturn

from hypernav.cli.guards.crashes import ReportedCrashError, crash_report
from hypernav.cli.guards.interruptions import Terminated, sigterm_as_interruption
from hypernav.cli.guards.statuses import ExitStatus
from hypernav.core.errors import HyPerNavError, ModelUnavailableError


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run a command and leave with its exit status, see `ExitStatus`."""
    sys.exit(_status(sys.argv[1:] if arguments is None else arguments))


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


def _say(message: str, status: ExitStatus) -> ExitStatus:
    print(f"hypernav: {message}", file=sys.stderr)
    return status
