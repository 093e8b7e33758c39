"""Checks of what a page tells to type and nobody can run here: do command, options, names exist?"""

import ast
import importlib
import re
import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import hypernav
from hypernav.app.build.data.sources import DATA_SOURCES
from hypernav.app.build.presets import preset
from hypernav.app.cli.command_line import COMMANDS, read_options
from hypernav.app.cli.options.agent import AgentOptions
from hypernav.core.errors import HyPerNavError
from hypernav.io.layered_config import layered

_ROOT = Path(__file__).parents[1]
_FIRST_WORDS = r"hypernav|python3?|pip|make|for|source|eval|export|ollama|vllm|llama-server|ros2|hf"
_COMMAND = re.compile(rf"^(?:\$ )?(?:{_FIRST_WORDS}|\.ci/run)\b(?!:)", re.MULTILINE)
_INLINE = re.compile(r"`((?:hypernav|python3?|make) [^`]+)`")
_RENAMED = re.compile(r"Unrecognized options|unknown command|there is no such|: it has no ")
_MISSING = re.compile("missing from hypernav|Missing value for argument '[a-z]")
_COMMENT = re.compile(r"(?:^|\s+)#\s.*$")
_BEFORE = ("do", "then", "$")
_UNFINISHED = "unfinished:"
_PASSES_ON = re.compile(r'main\(\["(\w+)", \*sys\.argv\[1:\]')
_TARGET = re.compile(r"^([\w-]+):", re.MULTILINE)


def has_commands(body: str) -> bool:
    """Whether a block without a language holds something to type."""
    return _COMMAND.search(body) is not None


def command_faults(body: str) -> Iterator[str]:
    """What is wrong with the commands of a shell block.

    Of ``hypernav`` the parser reads the options, of other programs of this checkout it is looked up
    whether they are there and know the options. All others are taken as they are.
    """
    for words in commands_of(body):
        said = " ".join(words)
        if words[0] == "hypernav":
            fault = _fault_of_command(words[1:])
        elif words[0].startswith("python") and words[1:] and words[1].endswith(".py"):
            fault = _fault_of_script(words[1], words[2:])
        elif words[0] == "make":
            targets = _TARGET.findall((_ROOT / "Makefile").read_text("utf-8"))
            named = {word for word in words[1:] if "=" not in word}
            fault = "" if named <= set(targets) else "there is no such target"
        else:
            fault = "a quotation has no end" if words[0] == _UNFINISHED else ""
        if fault:
            yield f"{said}: {fault}"


def inline_faults(text: str) -> Iterator[tuple[int, str]]:
    """What was renamed of commands within sentences, which may leave out what is of no matter.

    Args:
        text: A page without its fenced blocks.

    Yields:
        The position of a command, and what is wrong with it.
    """
    for found in _INLINE.finditer(text):
        said = " ".join(found[1].split())
        command, dashes, options = said.partition(" --")
        faults = list(command_faults(said))
        if any(map(_MISSING.search, faults)):  # then nothing is said of the others
            faults = list(command_faults(f"{command} x{dashes}{options}"))
        yield from [(found.start(), fault) for fault in faults if _RENAMED.search(fault)]


def commands_of(body: str) -> Iterator[list[str]]:
    """The words of each command of a shell block, without comments, redirections and ``…``."""
    text = ""
    for line in body.replace("\\\n", " ").splitlines():
        text += f"{_COMMENT.sub('', line)}\n"
        lexer = shlex.shlex(text, posix=True, punctuation_chars=";|&<>()")
        lexer.whitespace_split, lexer.commenters = True, ""
        try:
            tokens = [*lexer, ";"]
        except ValueError:  # a quotation goes on in the next line
            continue
        text = ""
        words: list[str] = []
        for word in tokens:
            if word and set(word) <= set(";|&<>()"):
                if words:
                    yield words
                words = []
            elif not (word == "…" or (not words and word in _BEFORE)):
                words.append(word)
    if text:
        yield [_UNFINISHED, text.strip()]


def python_faults(body: str) -> Iterator[str]:
    """What is wrong with a Python block: its syntax, or what it takes from hypernav."""
    try:
        tree = ast.parse(body)
    except SyntaxError as error:
        yield f"no Python: {error}"
        return
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("hypernav"):
            module = importlib.import_module(node.module or "")
            yield from (
                f"{node.module} has no {one.name}"
                for one in node.names
                if not hasattr(module, one.name)
            )
        elif isinstance(node, ast.Attribute) and ast.unparse(node.value) == "hypernav":
            yield from [] if hasattr(hypernav, node.attr) else [f"hypernav has no {node.attr}"]


def _fault_of_command(arguments: list[str]) -> str:
    """What the program says against the arguments of ``hypernav``; empty if nothing."""
    if arguments[:1] in (["--completion"], ["--version"]) or arguments[-1:] == ["--help"]:
        known = (*COMMANDS, arguments[-1], "--completion", "COMMAND")
        return "" if arguments[0] in known else f"unknown command '{arguments[0]}'"
    try:
        options = read_options(arguments)
        who = getattr(options, "who", None)
        if isinstance(who, AgentOptions):
            values = [one for one in who.set if not one.startswith("own.")]
            layered(preset(who.preset), environment={}, assignments=values)
        if isinstance(data := getattr(options, "dataset", None), str) and "$" not in data:
            DATA_SOURCES.find(data.partition("#")[0])
    except HyPerNavError as error:
        return str(error)
    return ""


def _fault_of_script(name: str, arguments: list[Any]) -> str:
    """Whether a script of this checkout is missing, or doesn't name one of the options."""
    if "/" not in name:  # one that the page itself made
        return ""
    path = _ROOT / name
    if not path.is_file():
        return "there is no such file"
    source = path.read_text("utf-8")
    if command := _PASSES_ON.search(source):
        return _fault_of_command([command[1], *arguments])
    options = [one.partition("=")[0] for one in arguments if re.fullmatch(r"--[a-z][\w-]*", one)]
    unknown = [
        one for one in options if one not in source and one[2:].replace("-", "_") not in source
    ]
    return f"it has no {', '.join(unknown)}" if unknown else ""
