"""The `hypernav` command."""

import contextlib
import io
import re
import sys
from collections.abc import Sequence
from typing import NoReturn

import tyro

from hypernav.cli.doctor import Doctor
from hypernav.cli.eval import Eval
from hypernav.cli.find import Find
from hypernav.cli.houses import HousesCommand, houses
from hypernav.cli.report import Report
from hypernav.core.errors import HyPerNavError

_COMMANDS = {"find": Find, "eval": Eval, "report": Report, "doctor": Doctor, "houses": houses}
_BOX = re.compile(r"[\u2500-\u257f]+")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run a command and leave with its exit status: 2 for bad usage or input."""
    command = _parse(_with_one_set(sys.argv[1:] if arguments is None else list(arguments)))
    try:
        status = command.run()
    except HyPerNavError as error:
        _fail(str(error))
    except KeyboardInterrupt:
        _fail("interrupted", status=130)
    else:
        sys.exit(status)


def _parse(arguments: list[str]) -> Find | Eval | Report | Doctor | HousesCommand:
    """Read the command line; what tyro says in a box is said in one line."""
    said = io.StringIO()
    try:
        with contextlib.redirect_stderr(said):
            return tyro.extras.subcommand_cli_from_dict(
                _COMMANDS,
                prog="hypernav",
                description="Find objects in buildings never seen before.",
                args=arguments,
            )
    except SystemExit as stop:
        if stop.code == 0:
            raise
        _fail(" ".join(_BOX.sub(" ", said.getvalue()).split()))


def _with_one_set(arguments: list[str]) -> list[str]:
    """Several ``--set`` made one, because of a repeated option only the last would count."""
    others: list[str] = []
    values: list[str] = []
    into = others
    for argument in arguments:
        if argument.startswith("-"):
            into = values if argument == "--set" else others
        if argument != "--set":
            into.append(argument)
    return [*others, "--set", *values] if values else arguments


def _fail(message: str, status: int = 2) -> NoReturn:
    print(f"hypernav: {message}", file=sys.stderr)
    sys.exit(status)
