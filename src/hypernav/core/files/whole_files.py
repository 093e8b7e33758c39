"""Files that are replaced in one step, so that they are never read half-written."""

import os
from pathlib import Path


def write_whole(path: Path, content: str | bytes) -> None:
    """Replace a file in one step, and wait for the disk. If that fails, the file is unchanged.

    Args:
        path: The file.
        content: Its new content; text is written as UTF-8.

    Raises:
        OSError: The disk is full, or the file can't be written.
    """
    fresh = path.with_name(f".{path.name}.new")
    try:
        with fresh.open("wb") as file:
            file.write(content.encode() if isinstance(content, str) else content)
            file.flush()
            os.fsync(file.fileno())
        fresh.replace(path)
    finally:
        fresh.unlink(missing_ok=True)
