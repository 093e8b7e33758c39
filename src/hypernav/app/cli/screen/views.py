"""Opens the views of a search, gives every step to all of them, and closes them at the end.

The packages that they need are imported only if a view is asked for.
"""

import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path
from typing import Any

from rich.markup import escape
from rich.status import Status

from hypernav.app.cli.guards.interruptions import Terminated, interrupt
from hypernav.app.cli.guards.outputs import check_file
from hypernav.app.cli.options.agent import ViewOptions
from hypernav.app.cli.screen.terminal import Terminal
from hypernav.app.show.video_frame import EpisodeInfo
from hypernav.core.components.registry import require
from hypernav.core.config import check_option
from hypernav.core.errors import ConfigError, OutputError
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.observation import Observation
from hypernav.core.trace import StepTrace, View, WatchedView
from hypernav.lab.episodes.recorder import OUTPUT_FILES

_LOOK_S = 0.05
_PACE_TO_WATCH = 5.0


def check_views(options: ViewOptions, folder: Path | None = None) -> None:
    """Refuse views that cannot be opened, before anything is loaded.

    Args:
        options: The views.
        folder: Folder of the results of the search; None without.

    Raises:
        ConfigError: The pace is impossible, two recordings name one file, or one names a file that
            the search writes itself.
        MissingExtraError: A package is not installed.
        OutputError: A file cannot be written.
    """
    if options.pace is not None:
        check_option("--pace", options.pace, (0.01, 1000.0), "steps a second")
    if options.view == "page":
        for module in ("fastapi", "uvicorn", "websockets"):
            require(module, extra="robot")
    if options.view == "rerun" or options.rrd is not None:
        require("rerun", extra="rerun")
    if options.view == "foxglove" or options.mcap is not None:
        require("foxglove", extra="foxglove")
    files = [file for file in (options.rrd, options.mcap) if file is not None]
    for file in files:
        check_file(file)
        if folder is not None:
            check_not_written_by_search(file, folder)
    if len({file.resolve() for file in files}) < len(files):
        raise ConfigError(f"--rrd and --mcap both name {options.rrd}; each needs its own file")


def check_not_written_by_search(file: Path, folder: Path) -> None:
    """Refuse an output file that the search itself writes to the folder of its results.

    Raises:
        ConfigError: It is one.
    """
    if file.name in OUTPUT_FILES and file.parent.resolve() == folder.resolve():
        raise ConfigError(f"{file} is written by the search itself; choose another name")


class Views:
    """All views of one search as one `hypernav.core.trace.View`, at a pace that people can follow.

    Attributes:
        watched: The views that people connect to.
        are_open: Whether there are any views.
    """

    def __init__(self, views: Sequence[View], pace: float | None) -> None:
        """Create it with open views.

        Args:
            views: The views; the caller closes them.
            pace: Largest number of steps a second; None chooses one by the kinds of views.
        """
        self._views = views
        self.are_open = bool(views)
        self.watched = [view for view in views if isinstance(view, WatchedView)]
        pace = pace or (_PACE_TO_WATCH if self.watched else None)
        self._step_s = 0.0 if pace is None else 1.0 / pace
        self._next_s = 0.0

    def add(
        self, step: StepTrace, grid: OccupancyGrid | None, observation: Observation | None
    ) -> None:
        """Show a step on all of them."""
        for view in self._views:
            view.add(step, grid, observation)

    def finish(self, result: Mapping[str, Any]) -> None:
        """Show the result on all of them.

        Raises:
            OutputError: Some could not be written; all others were.
        """
        errors = []
        for view in self._views:
            try:
                view.finish(result)
            except OutputError as error:
                errors.append(str(error))
        if errors:
            raise OutputError("; ".join(errors))

    def keep_pace(self) -> None:
        """Wait until the next step may be shown."""
        time.sleep(max(self._next_s - time.monotonic(), 0.0))
        self._next_s = time.monotonic() + self._step_s

    def await_watchers(self, status: Status) -> None:
        """Wait until somebody watches, because a simulated search would be over before that."""
        for view in self.watched:
            # Also with --quiet: nobody could connect without the address, and the search waits.
            Terminal().print(f"open {escape(view.address)}", soft_wrap=True)
            status.update("waiting; the search begins when it is opened …")
            while not view.has_watcher():
                time.sleep(_LOOK_S)

    def stay(self, console: Terminal) -> None:
        """Keep the views open until Ctrl-C."""
        if any(view.has_watcher() for view in self.watched):
            console.print("  it can be looked at until Ctrl-C", soft_wrap=True)
            try:
                while True:
                    time.sleep(3600.0)
            except Terminated:
                raise
            except KeyboardInterrupt:
                pass


@contextmanager
def opened_views(options: ViewOptions, info: EpisodeInfo, recorder: View | None) -> Iterator[Views]:
    """Open the views that the options ask for, and close them at the end of the block.

    Args:
        options: The options, already checked by `check_views`.
        info: Goal and components of the search.
        recorder: The view that writes page and video, which the caller closes; None for a search
            without.
    """
    with ExitStack() as opened:
        views = [] if recorder is None else [recorder]

        def open_view(view: View) -> None:
            views.append(opened.enter_context(closing(view)))

        if options.rrd is not None:
            from hypernav.app.show.viewers.rerun_view import RrdView

            open_view(RrdView(options.rrd, info))
        if options.mcap is not None:
            from hypernav.app.show.viewers.foxglove_view import McapView

            open_view(McapView(options.mcap, info))
        if options.view == "page":
            from hypernav.robot.server.page_view import PageView

            open_view(PageView(info, interrupt))
        if options.view == "rerun":
            from hypernav.app.show.viewers.rerun_view import RerunView

            open_view(RerunView(info))
        if options.view == "foxglove":
            from hypernav.app.show.viewers.foxglove_view import FoxgloveView

            open_view(FoxgloveView(info))
        yield Views(views, options.pace)
