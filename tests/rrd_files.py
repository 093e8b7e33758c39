"""What is in a file of rerun, by rerun's own reader."""

from pathlib import Path

from rerun.chunk import RrdReader


def images_in(path: Path) -> int:
    """Number of camera images."""
    chunks = RrdReader(path).store().stream()
    return sum(one.num_rows for one in chunks if str(one.entity_path) == "/map/camera/image")
