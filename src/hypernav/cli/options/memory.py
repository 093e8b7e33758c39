"""The options of `hypernav memory`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro


@dataclass(frozen=True)
class Options:
    """The memory, and what to do with it; without further options a page about it is written."""

    folder: Annotated[tyro.conf.Positional[Path], tyro.conf.arg(metavar="DIR")]
    """Folder of the memory."""
    forget: Annotated[tuple[str, ...] | None, tyro.conf.arg(metavar="NAME [NAME ...]")] = None
    """Names of things to forget, such as cup; all that were seen are forgotten, images stay."""
    forget_images: bool = False
    """Forget all key images."""
    export: Path | None = None
    """GeoJSON file to write with all things; coordinates and heights are metres of the map
    frame."""
    page: Path | None = None
    """HTML file of the page; DIR/index.html by default."""
