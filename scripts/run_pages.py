"""Run what pages of the documentation tell their readers to type, and compare what comes of it.

Each page is followed from its top to its end in an empty folder of its own:

- a ``python`` block is run; one that begins with a comment like ``# red_things.py`` becomes
  that file;
- an ``sh`` block is run and must succeed;
- a ``console`` block holds commands after ``$`` and what they print, with ``… s`` for times. A line
  with ``…`` alone stands for any number of lines. ``--write`` puts in what they print now.

What can't be run says why: ``<!-- not run: it needs a robot -->`` in the line above the block, or
``<!-- commands are not run: they take hours -->`` once on a page, for its blocks of commands.
Of these, and of commands within sentences, the program's own parser reads the options
(`page_commands`), and of Python the syntax is checked, and that what it takes from hypernav is
there. Blocks of other languages, and those without a language that hold no command, are only shown.
Of a notebook (``.ipynb``) all cells are run, in a kernel and an empty folder of its own. As many
pages are followed side by side as the machine has cores.

Run: python scripts/run_pages.py [--write] PAGE…
"""

import argparse
import difflib
import os
import re
import subprocess
import sys
import tempfile
import textwrap
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from itertools import chain
from pathlib import Path

from page_commands import command_faults, has_commands, inline_faults, python_faults

_MOST_S = 600.0
"""Time limit of a block, so that one that waits for ever is an error."""
_BLOCK = re.compile(
    r"^(?: *<!-- not run: (?P<why>[^\n]+) -->\n)?(?P<indent> *)```(?P<kind>\w*)\n(?P<body>.*?)"
    r"^(?P=indent)```$",
    re.DOTALL | re.MULTILINE,
)
_PAGE_WHY = re.compile(r"^<!-- commands are not run: .+ -->$", re.MULTILINE)
_RUN = ("python", "sh", "console")
_SHELL = ("sh", "bash", "")
_FILE = re.compile(r"# ([\w.-]+\.\w+)\n")
_NOTEBOOKS = ".ipynb"
_NOTEBOOK = """
import sys
import nbclient, nbformat
notebook = nbformat.read(sys.argv[1], as_version=4)
nbclient.NotebookClient(notebook, timeout=float(sys.argv[2])).execute()
"""
_SECONDS = re.compile(r"\b\d+(?:\.\d+)? (ms|s|min)\b")
_FIRST_RUN = re.compile(r"^(?:first run: compiling.*|…)\n", re.MULTILINE)


@dataclass(frozen=True)
class Block:
    """A fenced block of a page.

    Attributes:
        kind: Its language; empty if it names none.
        body: What it holds, without the indentation of the fence.
        line: Number of the line of its fence.
        is_run: Whether it is run, not only shown or checked.
        is_marked: Whether it, or its page, says why it isn't run.
    """

    kind: str
    body: str
    line: int
    is_run: bool
    is_marked: bool

    def check(self) -> Iterator[str]:
        """What is wrong with a block that isn't run."""
        is_shell = self.kind in _SHELL and has_commands(self.body)
        if not is_shell and self.kind not in _RUN:
            return
        if not self.is_marked:
            yield "neither run nor marked: say why above it, <!-- not run: REASON -->"
        yield from python_faults(self.body) if self.kind == "python" else command_faults(self.body)


def main() -> int:
    """Run the pages.

    Returns:
        The exit status: 0 if every page says what happens.
    """
    parser = argparse.ArgumentParser(description="Run what pages tell their readers to type.")
    parser.add_argument("pages", nargs="+", type=Path)
    parser.add_argument("--write", action="store_true", help="write what the commands print")
    parser.add_argument("--check", action="store_true", help="run nothing; check the other blocks")
    arguments = parser.parse_args()
    faults = [
        f"{page}:{fault}"
        for page in arguments.pages
        if page.suffix != _NOTEBOOKS
        for fault in faults_of_unrun(page.read_text("utf-8"))
    ]
    if not arguments.check:
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            found = pool.map(partial(_faults, write=arguments.write), arguments.pages)
            faults += chain.from_iterable(found)
    for fault in faults:
        print(fault)
    return 1 if faults else 0


def blocks_of(text: str) -> Iterator[Block]:
    """The fenced blocks of a page."""
    page_is_marked = _PAGE_WHY.search(text) is not None
    for found in _BLOCK.finditer(text):
        kind = found["kind"]
        is_marked = found["why"] is not None or (page_is_marked and kind in _SHELL)
        line = text.count("\n", 0, found.start("kind")) + 1
        body = textwrap.dedent(found["body"])
        yield Block(kind, body, line, kind in _RUN and not is_marked, is_marked)


def faults_of_unrun(text: str) -> Iterator[str]:
    """What is wrong with what a page says and nothing runs, each after its line."""
    for block in blocks_of(text):
        if not block.is_run:
            yield from (f"{block.line}: {fault}" for fault in block.check())
    sentences = _BLOCK.sub(lambda block: "\n" * block[0].count("\n"), text)
    for at, fault in inline_faults(sentences):
        yield f"{sentences.count(chr(10), 0, at) + 1}: {fault}"


def _faults(page: Path, *, write: bool) -> list[str]:
    """What is wrong with what a page runs."""
    faults = list[str]()
    with tempfile.TemporaryDirectory() as folder:
        if page.suffix == _NOTEBOOKS:
            command = [sys.executable, "-c", _NOTEBOOK, str(page.absolute()), str(_MOST_S)]
            done = _call(command, folder)
            return [f"{page}: a cell fails\n{done.stdout}"] if done.returncode else []
        for block in blocks_of(page.read_text("utf-8")):
            if not block.is_run:
                continue
            if block.kind == "console":
                printed = _console(block.body, folder)
                if write:
                    page.write_text(page.read_text("utf-8").replace(block.body, printed), "utf-8")
                elif not _agree(block.body, printed):
                    lines = (block.body.splitlines(), printed.splitlines())
                    faults.append("\n".join(difflib.unified_diff(*lines, str(page))))
            elif name := _FILE.match(block.body):
                (Path(folder) / name[1]).write_text(block.body, "utf-8")
            else:
                command = [sys.executable, "-c"] if block.kind == "python" else ["bash", "-euc"]
                done = _call([*command, block.body], folder)
                if done.returncode:
                    said = f"{page}:{block.line}: a block fails with {done.returncode}"
                    faults.append(f"{said}\n{block.body}\n{done.stdout}")
    return faults


def _console(body: str, folder: str) -> str:
    """A console block with what its commands print now."""
    lines = body.splitlines(keepends=True)
    printed = [
        line + _without_times(_call(["bash", "-c", line[2:]], folder).stdout)
        for line in lines
        if line.startswith("$ ")
    ]
    return "".join(printed)


def _without_times(printed: str) -> str:
    """What would be printed again, on a faster machine too."""
    return _SECONDS.sub(r"… \1", _FIRST_RUN.sub("", printed))


def _agree(said: str, printed: str) -> bool:
    """Whether a page says what is printed."""
    parts = [re.escape(part) for part in re.split(r"^…\n", said, flags=re.MULTILINE)]
    return re.fullmatch(r"(?:.*\n)*?".join(parts), printed) is not None


def _call(command: list[str], folder: str) -> subprocess.CompletedProcess[str]:
    """Run a command in a terminal of 100 columns without colours, on a network without a proxy."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    plain = {key: value for key, value in os.environ.items() if not key.lower().endswith("_proxy")}
    return subprocess.run(
        command,
        cwd=folder,
        env=plain | {"PATH": path, "COLUMNS": "100", "NO_COLOR": "1"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
        timeout=_MOST_S,
    )


if __name__ == "__main__":
    sys.exit(main())
