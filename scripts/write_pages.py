"""Write the parts of pages that are made from the program, so that they show without a build.

Such a part stands between a line that names it and its end:

- ``<!-- table: NAME -->`` … ``<!-- end of table -->``: a table of ``docs/results/data``
- ``<!-- all tables -->`` … ``<!-- end of all tables -->``: all of them
- ``<!-- help: COMMAND -->`` … ``<!-- end of help -->``: what ``hypernav COMMAND --help`` prints
- ``<!-- configuration -->`` … ``<!-- end of configuration -->``: every value of the configuration

Run: python scripts/write_pages.py PAGE…            # writes them
     python scripts/write_pages.py --check PAGE…    # fails if they differ from the program
"""

import argparse
import contextlib
import io
import os
import re
import sys
from collections.abc import Callable, Iterator, Sequence
from itertools import groupby
from pathlib import Path

from result_tables import Results, ResultsError

from hypernav.app.build.config_values import (
    ConfigValue,
    config_values,
    section_meanings,
    shown_value,
)
from hypernav.app.cli.command_line import run_command

_HEAD = r"^(?P<head><!-- (?P<kind>table|all tables|help|configuration)(?:: (?P<name>[^>]+?))? -->)$"
_PART = re.compile(
    rf"{_HEAD}\n"
    r"(?:(?!^<!-- ).)*?"
    r"^(?P<end><!-- end of (?P=kind) -->)$",
    re.MULTILINE | re.DOTALL,
)
_CODE = re.compile(r"``([^`]+)``|`([^`]+)`")
_LONGEST = 60
"""Characters of a default beyond which it is folded away, in a row of its own below the table."""


def written(page: str, results: Results) -> str:
    """A page with its parts as the program makes them today.

    Raises:
        ResultsError: There is no such table, or a part has no end.
    """
    closed = [part.start() for part in _PART.finditer(page)]
    for head in re.finditer(_HEAD, page, re.MULTILINE):
        if head.start() not in closed:
            raise ResultsError(f"{head['head']} has no <!-- end of {head['kind']} --> below it")
    makers: dict[str, Callable[[str], str]] = {
        "table": results.drawn,
        "all tables": lambda _: "\n\n".join(_titled(results)),
        "help": _help,
        "configuration": lambda _: "\n\n".join(_configuration()),
    }
    return _PART.sub(
        lambda part: f"{part['head']}\n{makers[part['kind']](part['name'])}\n{part['end']}", page
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the parts of pages, or check them.

    Returns:
        The exit status: 0 if the pages show what the program says.
    """
    parser = argparse.ArgumentParser(description="Write what pages show of the program.")
    parser.add_argument("pages", nargs="+", type=Path)
    parser.add_argument("--check", action="store_true", help="change nothing; fail if they differ")
    options = parser.parse_args(arguments)
    results, status = Results(), 0
    for page in options.pages:
        before = page.read_text("utf-8")
        try:
            now = written(before, results)
        except ResultsError as error:
            print(f"{page}: {error}", file=sys.stderr)
            return 1
        if options.check and now != before:
            print(f"{page} differs from what the program says; run `make pages`")
            status = 1
        elif now != before:
            page.write_text(now, "utf-8")
    return status


def _titled(results: Results) -> Iterator[str]:
    for name in results.names():
        yield f"## {results.table(name).title}"
        yield results.drawn(name)


def _help(command: str) -> str:
    """What ``hypernav COMMAND --help`` prints, in 88 columns without colours."""
    os.environ |= {"COLUMNS": "88", "NO_COLOR": "1"}
    said = io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.suppress(SystemExit):
        run_command([*command.split(), "--help"])
    lines = "\n".join(line.rstrip() for line in said.getvalue().strip().splitlines())
    return f"```text\n{lines}\n```"


def _configuration() -> Iterator[str]:
    """A heading and a table for each section; long texts below it."""
    words = section_meanings()
    for section, values in groupby(config_values(), lambda one: one.section):
        listed = list(values)
        yield f"## {section}\n\n{_markdown(words[section])}"
        head = "| value | default | possible | meaning | source |\n| --- | --- | --- | --- | --- |"
        yield "\n".join([head, *map(_row, listed)])
        for value in listed:
            if len(shown_value(value.default)) > _LONGEST:
                yield f"`{value.key}`:\n\n```text\n{_plain(value)}\n```"


def _row(value: ConfigValue) -> str:
    anchor = f'<a id="{value.key}"></a>`{value.key.partition(".")[2]}`'
    is_long = len(shown_value(value.default)) > _LONGEST
    default = "below" if is_long else f"`{shown_value(value.default)}`"
    if value.unit:
        default += f" {value.unit}"
    source: str = value.source
    if value.paper != value.default:
        source += f"; `paper`: `{shown_value(value.paper)}`"
    cells = (anchor, default, value.range, value.meaning, source)
    return f"| {' | '.join(_markdown(cell) for cell in cells)} |"


def _plain(value: ConfigValue) -> str:
    return value.default if isinstance(value.default, str) else ", ".join(value.default)


def _markdown(text: str) -> str:
    """A docstring's text for a cell of a table: one kind of code, no bars."""
    text = _CODE.sub(lambda code: f"`{code[1] or code[2]}`", text)
    return text.replace("|", "\\|")


if __name__ == "__main__":
    sys.exit(main())
