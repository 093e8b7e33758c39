"""The choice of the reader for a recording."""

from pathlib import Path

from hypernav.core.errors import RecordingError
from hypernav.robot.recordings.bag import is_bag, read_bag
from hypernav.robot.recordings.matched_frames import is_matched_frames, read_matched_frames
from hypernav.robot.recordings.recording import Recording
from hypernav.robot.recordings.tum import is_tum, read_tum
from hypernav.robot.ros.topics import CameraTopics

_FOLDERS = ((is_matched_frames, read_matched_frames), (is_tum, read_tum))


def open_recording(path: Path, topics: CameraTopics | None = None) -> Recording:
    """Read a recording of any known format, except its images.

    Args:
        path: A folder of images, or a bag.
        topics: Topics of the camera in a bag, where it has several.

    Raises:
        RecordingError: The path holds no recording, or a broken one.
        TopicChoiceError: No topic of a bag fits, or several do.
        MissingExtraError: The package that reads bags is not installed.
    """
    try:
        path.stat()
    except OSError as error:
        raise RecordingError(f"{path} cannot be read ({error.strerror})") from error
    if is_bag(path):
        return read_bag(path, topics or CameraTopics())
    for is_one, read in _FOLDERS:
        if path.is_dir() and is_one(path):
            return read(path)
    raise RecordingError(
        f"{path}: expected a folder with frame-*.pose.txt (3DMatch, 7-Scenes), one with rgb.txt, "
        "depth.txt and groundtruth.txt (TUM RGB-D), or a bag (a folder with metadata.yaml, a file "
        ".mcap, .db3 or .bag)"
    )
