"""The command `hypernav config`: what can be configured."""

import json
import textwrap
from collections.abc import Iterator
from itertools import groupby

from rich.markup import escape

from hypernav.app.build.config_values import (
    ConfigValue,
    config_schema,
    config_values,
    section_meanings,
    shown_value,
)
from hypernav.app.cli.guards.crashes import ExitStatus
from hypernav.app.cli.guards.outputs import check_file
from hypernav.app.cli.options.commands import ConfigOptions
from hypernav.app.cli.screen.terminal import Terminal
from hypernav.core.errors import OutputError
from hypernav.io.writing import write_whole


def run(options: ConfigOptions) -> int:
    """Run the command.

    Returns:
        The status of success.

    Raises:
        ConfigError: There is no such section or value.
        OutputError: The schema's file can't be written.
    """
    console = Terminal(stderr=False)
    if options.schema is not None:
        check_file(options.schema)
        try:
            write_whole(options.schema, f"{json.dumps(config_schema(), indent=1)}\n".encode())
        except OSError as error:
            raise OutputError(f"{options.schema} cannot be written ({error.strerror})") from error
        console.print("editors check a YAML file that begins with", soft_wrap=True)
        line = f"# yaml-language-server: $schema={options.schema}"
        console.print(line, soft_wrap=True, markup=False)
        return ExitStatus.SUCCESS
    words = section_meanings()
    for section, values in groupby(config_values(options.name), lambda one: one.section):
        console.print(f"[bold]{escape(section)}[/]: {escape(words[section])}\n")
        for value in values:
            console.print("\n".join(_lines(value)), soft_wrap=True)
            meaning = textwrap.wrap(value.meaning, max(console.width - 4, 20))
            console.print(textwrap.indent("\n".join(meaning), "    "), markup=False)
            console.print()
    return ExitStatus.SUCCESS


def _lines(value: ConfigValue) -> Iterator[str]:
    unit = f" {value.unit}" if value.unit else ""
    yield f"[cyan]{escape(f'{value.key} = {shown_value(value.default)}')}[/]{escape(unit)}"
    differs = value.paper != value.default
    paper = f"; preset paper: {shown_value(value.paper)}" if differs else ""
    yield f"    [dim]{escape(f'{value.range}; {value.source}{paper}')}[/]"
