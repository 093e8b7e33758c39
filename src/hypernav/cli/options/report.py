"""The options of `hypernav report`."""

from dataclasses import dataclass
from pathlib import Path

import tyro


@dataclass(frozen=True)
class Options:
    """The evaluations to report on, and the folder of the report."""

    runs: tyro.conf.Positional[tuple[Path, ...]]
    """Folders that hypernav eval wrote; the first is the one that others are compared with."""
    compare: bool = False
    """Compare every run with the first one, episode by episode."""
    published: bool = False
    """Set every run beside the HyPerNav paper's rows, scene by scene and goal by goal."""
    out: Path | None = None
    """Folder of the report; by default that of the only run, or compared/ in the first run's."""
    quiet: bool = False
    """Print errors only."""
