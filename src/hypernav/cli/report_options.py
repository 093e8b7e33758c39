"""What can be said to `hypernav report`."""

from dataclasses import dataclass
from pathlib import Path

import tyro


@dataclass(frozen=True)
class Options:
    """Which evaluations, and where the report goes."""

    runs: tyro.conf.Positional[tuple[Path, ...]]
    """Folders that hypernav eval wrote; the first is what others are compared with."""
    compare: bool = False
    """Compare every run with the first one, episode by episode."""
    out: Path | None = None
    """Folder for the report; by default that of the only run, or the first run's compared/."""
    quiet: bool = False
    """Say nothing but errors."""
