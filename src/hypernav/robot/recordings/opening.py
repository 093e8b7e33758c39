"""The choice of the reader for a recording."""

from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

from hypernav.core.errors import RecordingError
from hypernav.robot.recordings.bag import is_bag, read_bag
from hypernav.robot.recordings.depth_unit import in_unit, unit_doubt
from hypernav.robot.recordings.lost_poses import without_lost_poses
from hypernav.robot.recordings.matched_frames import is_matched_frames, read_matched_frames
from hypernav.robot.recordings.recording import Recording
from hypernav.robot.recordings.scannet import is_scannet, read_scannet
from hypernav.robot.recordings.tum import is_tum, read_tum
from hypernav.robot.ros.topics import CameraTopics

_RECORD = "record a bag of it with the poses of a SLAM program"
_OTHER_FORMATS = {
    ".mkv": "a video, as Azure Kinect records it, without poses: play it with 'roslaunch "
    f"azure_kinect_ros_driver driver.launch recording_file:={{path}}', and {_RECORD}",
    ".svo": "of a ZED camera: play it with 'ros2 launch zed_wrapper zed_camera.launch.py "
    f"camera_model:=zed2i svo_path:={{path}}' (your model of camera), and {_RECORD}",
    ".sens": "of ScanNet: unpack it with 'python2 reader.py --filename {path} --output_path DIR "
    "--export_depth_images --export_color_images --export_poses --export_intrinsics' of its "
    "SensReader, and give DIR",
}
"""What recordings of other formats are, and the way to one that is read."""
_FOLDERS = (
    (is_matched_frames, read_matched_frames),
    (is_tum, read_tum),
    (is_scannet, read_scannet),
)


def open_recording(
    path: Path, topics: CameraTopics | None = None, *, depth_per_metre: float | None = None
) -> Recording:
    """Read a recording of any known format, except most of its images.

    Args:
        path: A folder of images, or a bag.
        topics: Topics of the camera in a bag, where it has several.
        depth_per_metre: Depth value of one metre, where it is not that of the format.

    Raises:
        RecordingError: The path holds no recording, or a broken one.
        TopicChoiceError: No topic of a bag fits, or several do.
        MissingExtraError: The package that reads bags is not installed.
    """
    try:
        path.stat()
    except OSError as error:
        raise RecordingError(f"{path} cannot be read ({error.strerror})") from error
    recording = without_lost_poses(_read(path, topics or CameraTopics()))
    with ExitStack() as opened:
        opened.callback(recording.close)
        if depth_per_metre is not None:
            recording = in_unit(recording, depth_per_metre)
        recording = replace(recording, notes=[*recording.notes, *unit_doubt(recording)])
        opened.pop_all()
    return recording


def _read(path: Path, topics: CameraTopics) -> Recording:
    for is_one, read in _FOLDERS:
        if path.is_dir() and is_one(path):
            return read(path)
    if is_bag(path):
        return read_bag(path, topics)
    other = _OTHER_FORMATS.get(path.suffix.lower().replace(".svo2", ".svo"))
    if other is not None:
        raise RecordingError(f"{path} is {other.format(path=path)}")
    raise RecordingError(
        f"{path}: expected a folder with frame-*.pose.txt (3DMatch, 7-Scenes), one with rgb.txt, "
        "depth.txt and groundtruth.txt (TUM RGB-D), one with color, depth and pose (ScanNet), or a "
        "bag (a folder with metadata.yaml, a file .mcap, .db3 or .bag)"
    )
