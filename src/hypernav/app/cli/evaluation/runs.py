"""The command `hypernav runs`: one page over all runs in a folder."""

import time
from pathlib import Path

from hypernav.app.cli.guards.crashes import ExitStatus
from hypernav.app.cli.guards.outputs import check_file
from hypernav.app.cli.options.commands import RunsOptions
from hypernav.app.cli.screen.terminal import Terminal
from hypernav.core.errors import OutputError, RunFolderError
from hypernav.core.naming.words import number_of
from hypernav.io.writing import write_whole
from hypernav.lab.evaluation.report.runs_page import PAGE_NAME, changed, overview, runs_page

_EVERY_S = 5.0
"""Time between two looks at the runs while they are followed, and between two loads of the page."""


def run(options: RunsOptions) -> int:
    """Run the command.

    Returns:
        The status of success.

    Raises:
        RunFolderError: There is no such folder, or no run in it.
        OutputError: The page can't be written.
        KeyboardInterrupt: The runs are followed, and somebody pressed Ctrl-C.
    """
    if not options.folder.is_dir():
        raise RunFolderError(f"there is no folder {options.folder}; hypernav find GOAL begins runs")
    page = options.folder / PAGE_NAME
    check_file(page)
    console = Terminal(quiet=options.quiet)
    seen = changed(options.folder)
    if not seen and not options.follow:
        raise RunFolderError(f"{options.folder} holds no run; hypernav find and eval write some")
    console.print(f"{_write(options, page)}; open {page}", markup=False, soft_wrap=True)
    while options.follow:
        time.sleep(_EVERY_S)
        if (now := changed(options.folder)) != seen:
            seen = now
            console.print(_write(options, page), markup=False)
    return ExitStatus.SUCCESS


def _write(options: RunsOptions, page: Path) -> str:
    """Write the page; returns what it shows."""
    found = overview(options.folder)
    name = options.folder.resolve().name
    text = runs_page(found, name, reload_s=_EVERY_S if options.follow else None)
    try:
        write_whole(page, text)
    except OSError as error:
        raise OutputError(f"{page} cannot be written ({error.strerror})") from error
    searches = number_of(len(found.searches), "search", "searches")
    words = f"{number_of(len(found.runs), 'run')}, {searches}"
    return words + (f", {len(found.left_out)} left out" if found.left_out else "")
