"""The options that choose views, shared by all commands that show a search."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro


@dataclass(frozen=True)
class ViewOptions:
    """Where to show the search besides its own page and video."""

    view: Literal["page", "rerun", "foxglove"] | None = None
    """Watch the search live: page, in a browser, with a STOP; rerun, in its viewer; foxglove,
    at a WebSocket."""
    rrd: Path | None = None
    """File to record the search for rerun."""
    mcap: Path | None = None
    """File to record the search for Foxglove and other readers of MCAP."""
    pace: float | None = None
    """Largest number of steps a second, to watch them; 5 with --view page or foxglove, else no
    limit."""


@dataclass(frozen=True)
class RobotViewOptions:
    """Where to show what a robot does besides its page and video, and the server's page.

    The options of `ViewOptions` except those for the pace, which is the robot's own.
    """

    view: Literal["rerun", "foxglove"] | None = None
    """Watch it live: rerun, in its viewer; foxglove, at a WebSocket."""
    rrd: Path | None = None
    """File to record it for rerun."""
    mcap: Path | None = None
    """File to record it for Foxglove and other readers of MCAP."""

    @property
    def chosen(self) -> ViewOptions:
        """The same as options of all views."""
        return ViewOptions(view=self.view, rrd=self.rrd, mcap=self.mcap)


FlatRobotViewOptions = Annotated[RobotViewOptions, tyro.conf.arg(name="")]
FlatViewOptions = Annotated[ViewOptions, tyro.conf.arg(name="")]
