"""The choice of the reader for a recording."""

from pathlib import Path

from hypernav.core.errors import RecordingError
from hypernav.robot.recordings.matched_frames import is_matched_frames, read_matched_frames
from hypernav.robot.recordings.recording import Recording
from hypernav.robot.recordings.tum import is_tum, read_tum

_READERS = ((is_matched_frames, read_matched_frames), (is_tum, read_tum))


def open_recording(folder: Path) -> Recording:
    """Read a recording of any known format, all but its images.

    Raises:
        RecordingError: The folder holds none, or it is broken.
    """
    if not folder.is_dir():
        raise RecordingError(f"{folder} is not a folder")
    for is_one, read in _READERS:
        if is_one(folder):
            return read(folder)
    raise RecordingError(
        f"{folder}: expected frame-*.pose.txt (3DMatch, 7-Scenes), or rgb.txt, depth.txt and "
        "groundtruth.txt (TUM RGB-D)"
    )
