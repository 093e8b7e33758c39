"""Reads a command line: the command and its options.

The start is fast because help and errors need only the options: ``options.commands`` imports very
little. The module ``NAME`` of a command holds the function ``run``, imports all that it needs, and
is loaded only to be called.
"""

import contextlib
import difflib
import gc
import importlib
import io
import itertools
import os
import re
import shutil
import sys
import traceback
from collections.abc import Callable, Sequence
from dataclasses import make_dataclass
from importlib.metadata import version
from typing import Any, NoReturn

import tyro

from hypernav.app.cli.options.commands import OPTIONS
from hypernav.app.cli.options.declaring import READING
from hypernav.app.cli.screen.terminal import Terminal
from hypernav.core.errors import ComponentError, ConfigError

COMMANDS = {
    "find": "Search for an object in a simulated building and leave a page about it.",
    "eval": "Run the episodes of a benchmark; the same command resumes an interrupted run.",
    "ablate": "Run variants of the method on the same episodes, and say what each part is worth.",
    "report": "Write a page, a CSV file and LaTeX tables about one or more evaluations.",
    "runs": "Write one page over all runs in a folder: filter, sort, compare two, see their films.",
    "doctor": "Examine a vision-language model, or the data of benchmarks, and say what to change.",
    "exam": "Ask a model questions with known answers, and say whether and where it will help.",
    "compare": "Compare the simulator with habitat-sim, pose by pose, in a scene of your own.",
    "scene": "Write the navigation mesh that habitat-sim computes of a scene, for any robot.",
    "memory": "Write a page about what searches have learned of a building, or forget some of it.",
    "config": "List every value of the configuration: default, unit, range, meaning and source.",
    "serve": "Take the observations of robots over the network, and answer each with an action.",
    "robot": "Drive a robot by ROS 2 or a simulated one, replay recordings, report on trials.",
    "houses": "Generated buildings: pages about them, files for other programs, splits, episodes.",
}
_OF_EVALUATION = frozenset({"ablate", "compare", "eval", "exam", "report", "runs"})
"""Commands whose modules lie in `app.cli.evaluation`; the others lie beside this one."""
_LEAST_MB = 1500
"""Least size of the address space in which libraries load."""
_SHELLS = ("bash", "zsh", "fish")
_MOST_CHARACTERS = 500
_LEAST_COLUMNS = 20
"""Narrowest terminal for which help and errors are laid out: tyro never ends in a narrower one."""
_PLAINER = {
    "Error parsing ": "",
    "Missing from hypernav ": "missing from hypernav ",
    "invalid literal for int() with base 10: ": "expected a whole number, got ",
    "could not convert string to float: ": "expected a number, got ",
    "Could not find valid parse for arguments: ": "expected numbers, got ",
}
"""Plainer words for some of tyro's."""


def run_command(arguments: Sequence[str]) -> int:
    """Run the command that a command line asks for.

    Args:
        arguments: The arguments after the name of the program.

    Returns:
        Its exit status.

    Raises:
        ConfigError: The command line cannot be understood, or a limit leaves no room for libraries.
        HyPerNavError: The command failed; the message gives the reason.
        ComponentError: A component of the user's own ended the program.
        SystemExit: The command line asks for help, which has been printed.
    """
    if shutil.get_terminal_size().columns < _LEAST_COLUMNS:
        os.environ["COLUMNS"] = str(_LEAST_COLUMNS)
    name, *rest = list(arguments) or [""]
    if name in {"-h", "--help"}:
        _help()
    if name == "--version":
        Terminal(stderr=False).print(f"hypernav {version('hypernav')}")
        return 0
    if name == "--completion":
        _completion(rest)
    options = read_options(arguments)
    _check_address_space()
    room = "evaluation." if name in _OF_EVALUATION else ""
    run = _imported(f"hypernav.app.cli.{room}{name}")
    try:
        return run(options)
    except SystemExit as end:  # as from a signal handler of a component
        raise ComponentError(
            f"a component ended the program (SystemExit: {end}), outside a call of this program",
            traceback.format_exc(),
        ) from end


def read_options(arguments: Sequence[str]) -> Any:
    """The options of a command line, of the class ``Options`` of its command; nothing is run.

    Args:
        arguments: The arguments after the name of the program.

    Raises:
        ConfigError: The command line cannot be understood.
        SystemExit: The command line asks for help, which has been printed.
    """
    name, *rest = list(arguments) or [""]
    if name not in COMMANDS:
        raise ConfigError(_unknown(name))
    _refuse_empty(rest)
    if not {"-h", "--help"}.isdisjoint(rest):
        # Alone, since tyro's help leaves out what has been given; a subcommand has help of its own.
        is_one = isinstance(OPTIONS[name], type)
        rest = ["--help"] if is_one else [*rest[:1], "--help"]
    return _parse(name, _with_one_set(rest))


def _check_address_space() -> None:
    """Refuse to begin under a small ``ulimit -v``.

    Some libraries end the process by a signal where memory is refused while they load, and OpenBLAS
    tries again for ever, in a loop that no signal interrupts.

    Raises:
        ConfigError: The limit is too small.
    """
    if sys.platform == "win32":
        return
    import resource

    most, _ = resource.getrlimit(resource.RLIMIT_AS)
    if most != resource.RLIM_INFINITY and most < _LEAST_MB * 2**20:
        raise ConfigError(
            f"this process may take {most / 2**20:.0f} MB of addresses (ulimit -v), and libraries "
            f"need {_LEAST_MB} to load, a search twice that; raise the limit"
        )


def _imported(module: str) -> Callable[[Any], int]:
    """The function of a command's module.

    What it imports stays to the end: the search for garbage among it took a third of the time of
    the shortest commands, most of it when Python ends.
    """
    if module not in sys.modules:
        searches = gc.isenabled()
        gc.disable()
        try:
            importlib.import_module(module)
        finally:
            gc.freeze()
            if searches:
                gc.enable()
    return sys.modules[module].run


def _parse(name: str, arguments: list[str]) -> Any:
    """The options of a command; an error that tyro prints in a box becomes one line."""
    said = io.StringIO()
    try:
        with _help_on_terminal(), contextlib.redirect_stderr(said):
            return tyro.cli(
                OPTIONS[name],
                prog=f"hypernav {name}",
                description=COMMANDS[name],
                args=arguments,
                config=(tyro.conf.PositionalMetavarFromFieldName,),
                registry=READING,
            )
    except SystemExit as stop:
        if stop.code == 0:
            raise
        raise ConfigError(f"{_plain(said.getvalue())}; see hypernav {name} --help") from None


def _plain(said: str) -> str:
    """An error of tyro in one line, without its help.

    tyro has no public form of an error but the text that it prints: a box with a title, and in it
    what is wrong, a ruled line, and help.
    """
    parts = [""]
    for line in said.splitlines()[1:-1]:
        text = line.strip("│ ")
        if text.startswith(("──", "---")):  # without UTF-8 there is no frame, and the rules are -
            parts.append("")
        else:
            parts[-1] += f" {text}"
    wrong, *help_texts = (" ".join(part.split()) for part in parts if part.strip())
    wrong = wrong.partition(" Got errors:")[0].removesuffix(".")
    for word, plainer in _PLAINER.items():
        wrong = wrong.replace(word, plainer)
    if len(wrong) > _MOST_CHARACTERS:
        wrong = f"{wrong[:_MOST_CHARACTERS]} …"
    similar = [text for text in help_texts if text.startswith(("Perhaps you meant", "Available"))]
    if wrong.startswith("Unrecognized options: ") and "--" not in wrong:
        words = wrong.removeprefix("Unrecognized options: ")
        similar.append(
            "to compare runs: hypernav report A B --compare"
            if os.path.isdir(words)
            else 'several words that are one name go in quotes, as in "potted plant"'
        )
    return "; ".join([wrong, *similar])


def _help() -> NoReturn:
    """Print the list of commands; empty dataclasses take the place of their options."""
    commands = {
        name: make_dataclass(name, [], namespace={"__doc__": words})
        for name, words in COMMANDS.items()
    }
    with _help_on_terminal():
        tyro.extras.subcommand_cli_from_dict(
            commands,
            prog="hypernav",
            description="Find objects in buildings never seen before.",
            args=["--help"],
        )
    raise AssertionError("help ends the program")


def _completion(arguments: Sequence[str]) -> NoReturn:
    """Print what a shell needs to complete commands and options.

    Raises:
        ConfigError: The shell is unknown.
    """
    if len(arguments) != 1 or arguments[0] not in _SHELLS:
        raise ConfigError(f"--completion takes one shell: {', '.join(_SHELLS)}")
    script = io.StringIO()
    with contextlib.suppress(SystemExit), contextlib.redirect_stdout(script):
        tyro.extras.subcommand_cli_from_dict(
            OPTIONS,
            prog="hypernav",
            args=["--tyro-print-completion", arguments[0]],
            registry=READING,
        )
    with _help_on_terminal():
        print(_with_offers(script.getvalue()))
    sys.exit(0)


def _with_offers(script: str) -> str:
    """A script of tyro's that also offers names of scenes and agents, and then files.

    tyro offers values only of options that take no others, and these take files and modules, too.
    """
    from hypernav.app.build.components.registries import AGENTS
    from hypernav.app.build.data.scenes import SCENES

    offers = {
        "scene": [form.replace(":N", ":7") for form in SCENES.forms],
        "agent": [form for form in AGENTS.forms if ":" not in form],
    }
    for option, values in offers.items():
        known = rf"('flags': \['--{option}'\], 'description': (?:(?!'flags').)*?'type': )'\w+'"
        script = re.sub(known, rf"\1'choice', 'choices': {values}", script, flags=re.DOTALL)
    ending = "return completions\n"
    files = "return completions or ['__TYRO_COMPLETE_FILES__']\n"
    return script.replace(f"{' ' * 32}{ending}", f"{' ' * 32}{files}")


def _unknown(name: str) -> str:
    """The error message for a mistyped or missing command."""
    close = difflib.get_close_matches(name, COMMANDS, n=1)
    found = f"unknown command '{name}'" if name else "no command"
    hint = f"did you mean '{close[0]}'? " if close else ""
    return f"{found}; {hint}commands: {', '.join(COMMANDS)}; hypernav --help explains them"


def _with_one_set(arguments: list[str]) -> list[str]:
    """Merge several ``--set`` into one, since tyro keeps only the last of a repeated option."""
    others: list[str] = []
    values: list[str] = []
    into = others
    for argument in arguments:
        if argument.startswith("--set="):
            values.append(argument.removeprefix("--set="))
            continue
        if argument.startswith("-"):
            into = values if argument == "--set" else others
        if argument != "--set":
            into.append(argument)
    return [*others, "--set", *values] if values else arguments


def _refuse_empty(arguments: Sequence[str]) -> None:
    """Refuse options with an empty value, for example from an unset shell variable.

    Raises:
        ConfigError: An option has an empty value.
    """
    for before, argument in itertools.pairwise(["", *arguments]):
        option, equals, value = argument.partition("=")
        if option.startswith("--") and equals and not value:
            raise ConfigError(f"{option} is empty; give a value, or leave the option out")
        if before.startswith("--") and "=" not in before and not argument:
            raise ConfigError(f"{before} is empty; give a value, or leave the option out")


def _help_on_terminal() -> contextlib.redirect_stdout[Any]:
    """Let a reader close the output of help early, as in ``--help | head``."""
    return contextlib.redirect_stdout(Terminal(stderr=False).file)
