"""What a stranger may put in place of a file, so that it leads elsewhere or nowhere."""

import os
from pathlib import Path


def lead(path: Path, kind: str, elsewhere: Path) -> None:
    """Make a link or hard link to a file elsewhere, or a pipe."""
    match kind:
        case "link":
            path.symlink_to(elsewhere)
        case "hard link":
            path.hardlink_to(elsewhere)
        case "pipe":
            os.mkfifo(path)
        case _:
            raise ValueError(kind)
