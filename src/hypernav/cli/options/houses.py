"""The options of `hypernav houses`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro


@dataclass(frozen=True)
class Episodes:
    """Write the episodes of a split in Habitat's ObjectNav format."""

    split: tyro.conf.Positional[str]
    """houses-val, houses-ovon (phrases), houses-train (for tuning), or -val and -train of
    offices and shops."""
    out: Path
    """File to write (.json.gz or .json), or a folder for a file per building, as in Habitat."""
    houses: str | None = None
    """Only the buildings FIRST:END (END is not included); any numbers for a -train split."""
    count: int | None = None
    """Number of episodes, counted from the first; all by default."""
    quiet: bool = False
    """Print errors only."""


@dataclass(frozen=True)
class Splits:
    """List the splits: their buildings, their number of episodes, and their kind of goals."""


@dataclass(frozen=True)
class Export:
    """Write a building as GLB with the files that Habitat needs, or a split as Habitat's data.

    A split is written with its episodes, as one folder that Habitat can use unchanged.
    """

    what: Annotated[tyro.conf.Positional[str], tyro.conf.arg(metavar="ID|SPLIT")]
    """Number of a house, for example 1234; or offices:N, shops:N; or houses-val, or some buildings
    of a split: houses-val#1000:1004."""
    out: Path | None = None
    """Folder to write to; runs/house-ID, runs/office-ID … by default. Habitat's data folder for a
    split; runs/SPLIT by default."""
    quiet: bool = False
    """Print errors only."""


@dataclass(frozen=True)
class Show:
    """Make a page about a building: a walk through its plan, views, list of objects."""

    building: Annotated[tyro.conf.Positional[str], tyro.conf.arg(metavar="ID")]
    """Number of a house, for example 1234; or offices:N, shops:N."""
    out: Path | None = None
    """The page (.html), or the folder for it; runs/house-ID, runs/office-ID … by default."""
    quiet: bool = False
    """Print errors only."""


Options = (
    Annotated[Show, tyro.conf.subcommand("show")]
    | Annotated[Export, tyro.conf.subcommand("export")]
    | Annotated[Episodes, tyro.conf.subcommand("episodes")]
    | Annotated[Splits, tyro.conf.subcommand("splits")]
)
"""One of the subcommands of `hypernav houses`."""
