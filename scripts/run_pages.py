"""Run what pages of the documentation tell their readers to type, and compare what comes of it.

Each page is followed from its top to its end in an empty folder of its own:

- a ``python`` block is run; one that begins with a comment like ``# red_things.py`` becomes
  that file;
- an ``sh`` block is run and must succeed;
- a ``console`` block holds commands after ``$`` and what they print, with ``… s`` for times. A line
  with ``…`` alone stands for any number of lines. ``--write`` puts in what they print now.

All other blocks are only shown. As many pages are followed side by side as the machine has cores.

Run: python scripts/run_pages.py [--write] PAGE…
"""

import argparse
import difflib
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from itertools import chain
from pathlib import Path

_MOST_S = 600.0
"""Time limit of a block, so that one that waits for ever is an error."""
_BLOCK = re.compile(r"^```(python|sh|console)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
_FILE = re.compile(r"# ([\w.-]+\.\w+)\n")
_SECONDS = re.compile(r"\b\d+(?:\.\d+)? (ms|s|min)\b")
_FIRST_RUN = re.compile(r"^(?:first run: compiling.*|…)\n", re.MULTILINE)


def main() -> int:
    """Run the pages.

    Returns:
        The exit status: 0 if every page says what happens.
    """
    parser = argparse.ArgumentParser(description="Run what pages tell their readers to type.")
    parser.add_argument("pages", nargs="+", type=Path)
    parser.add_argument("--write", action="store_true", help="write what the commands print")
    arguments = parser.parse_args()
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        faults = list(pool.map(partial(_faults, write=arguments.write), arguments.pages))
    for fault in chain.from_iterable(faults):
        print(fault)
    return 1 if any(faults) else 0


def _faults(page: Path, *, write: bool) -> list[str]:
    """What is wrong with a page."""
    text, faults = page.read_text("utf-8"), list[str]()
    with tempfile.TemporaryDirectory() as folder:
        for block in _BLOCK.finditer(text):
            kind, body = block.groups()
            if kind == "console":
                printed = _console(body, folder)
                if write:
                    page.write_text(page.read_text("utf-8").replace(body, printed), "utf-8")
                elif not _agree(body, printed):
                    diff = difflib.unified_diff(body.splitlines(), printed.splitlines(), str(page))
                    faults.append("\n".join(diff))
            elif name := _FILE.match(body):
                (Path(folder) / name[1]).write_text(body, "utf-8")
            else:
                command = [sys.executable, "-c"] if kind == "python" else ["bash", "-euc"]
                done = _call([*command, body], folder)
                if done.returncode:
                    said = f"{page}: a block fails with {done.returncode}"
                    faults.append(f"{said}\n{body}\n{done.stdout}")
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
