"""The choice of the reader for a recording, and doubts about its depth unit and its poses.

Formats mark a lost pose by infinities, zeros or by no line at all, which their readers leave out.
Some programs write the identity instead. At the beginning of a recording it is right, since the
first camera often is the world, unless the next pose is far away. Once the camera has moved, it
never comes back to the last digit, and a frame drawn there would spoil the map.
"""

import math
import sys
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import numpy as np
from jaxtyping import Float32, Float64

from hypernav.core.errors import RecordingError
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Transform
from hypernav.io.reading import check_file
from hypernav.robot.recordings.bag import is_bag, read_bag
from hypernav.robot.recordings.frame_files import (
    is_matched_frames,
    is_scannet,
    is_tum,
    read_matched_frames,
    read_scannet,
    read_tum,
)
from hypernav.robot.recordings.recording import RecordedFrame, Recording, left_out
from hypernav.robot.ros.topics import CameraTopics

_MOST_FRAMES = 5
_COLUMNS = 80
_USUAL = (1000.0, 5000.0, 1.0, 10000.0, 4000.0, 100.0)
_MOVED_M = 0.15
"""Way after which a second look at the same things tells their distance."""
_LEAST_POINTS = 50
_CLEAR = 0.02
"""Relative difference of depth that no noise of a camera makes."""
_WRONG = 0.04
"""One that poses of another convention make; noisy odometry and calibration make less."""
_POSES_IN_MM = 50.0
"""Factor by which depth would have to be in a smaller unit, that rather the poses are."""
_NEAR_M, _FAR_M = (1.0, 0.4), (4.0, 8.0)
"""A robot in a room sees a tenth of things beyond the first, and half of them beyond the second; it
also sees a tenth of them before the third, and half of them before the fourth."""


def in_unit(recording: Recording, per_metre: float) -> Recording:
    """A recording whose depth images have another unit than its format says.

    Args:
        recording: The recording, read by its format's unit.
        per_metre: Depth value of one metre.
    """
    factor = np.float32(recording.depth_per_metre / per_metre)

    def scaled(frame: RecordedFrame) -> RecordedFrame:
        def depth() -> Float32[np.ndarray, "height width"]:
            return frame.depth() * factor

        return replace(frame, depth=depth)

    frames = [scaled(frame) for frame in recording.frames]
    return replace(recording, frames=frames, depth_per_metre=per_metre)


def unit_doubt(recording: Recording) -> list[str]:
    """The note that another unit fits the depth better than the recording's; or none.

    Where the camera moved, two views of the same things agree in the right unit only. Elsewhere,
    things that are all too near or too far for a robot in a room make a note.

    Raises:
        RecordingError: A depth image cannot be read.
    """
    per_metre = recording.depth_per_metre
    depths, view_pairs = _depths_and_view_pairs(recording)
    units = dict.fromkeys((per_metre, *_USUAL))
    apart = {unit: _difference(recording.camera, view_pairs, per_metre / unit) for unit in units}
    best = min(apart, key=lambda unit: apart[unit])
    if best == per_metre and apart[best] < _WRONG:
        return []
    if apart[best] < _WRONG and apart[per_metre] > max(_CLEAR, 2.0 * apart[best]):
        or_poses = " (or the poses are in millimetres)" if _POSES_IN_MM * best <= per_metre else ""
        return [
            f"depth and poses contradict each other if the value {per_metre:g} is one metre, "
            f"and agree with --depth-per-metre {best:g}{or_poses}"
        ]
    if _WRONG < apart[best] < math.inf and math.isfinite(apart[per_metre]):
        return [
            f"depth and poses contradict each other by {apart[per_metre]:.0%} in every usual unit; "
            "are the poses from camera to world, in metres, with the camera's x to the right, y "
            "down and z forward, and quaternions in the order x y z w?"
        ]
    returns = np.concatenate([depth[depth > 0.0] for depth in depths])
    if returns.size == 0 or (side := _misfit(returns)) is None:
        return []
    least_m = float(np.quantile(returns, 0.9 if side == "nearer" else 0.1))
    fitting = next((u for u in _USUAL if _misfit(returns * (per_metre / u)) is None), None)
    advice = (
        "another value can be said by --depth-per-metre"
        if fitting is None
        else f"--depth-per-metre {fitting:g} would make it {least_m * per_metre / fitting:.2g} m"
    )
    return [
        f"nine tenths of the depth are {side} than {least_m:.2g} m if the value {per_metre:g} is a "
        f"metre; {advice}"
    ]


_Depth = Float32[np.ndarray, "height width"]
_ViewPairs = list[tuple[Transform, _Depth, _Depth]]
"""For two views of the same things from different places the transform from the first camera to the
second, and the depth of both."""


def _depths_and_view_pairs(recording: Recording) -> tuple[list[_Depth], _ViewPairs]:
    """Depth spread over the recording, and pairs of views of the same things."""
    frames = recording.frames
    depths, view_pairs = [], []
    for i in range(0, len(frames), max(len(frames) // _MOST_FRAMES, 1)):
        first, depth = frames[i], frames[i].depth()
        depths.append(depth)
        here = first.camera_to_world.translation
        second = next((one for one in frames[i:] if _moved_m(one, here) >= _MOVED_M), None)
        if second is not None:
            first_to_second = second.camera_to_world.inverse() @ first.camera_to_world
            view_pairs.append((first_to_second, depth, second.depth()))
    return depths, view_pairs


def _moved_m(frame: RecordedFrame, here: Float64[np.ndarray, "3"]) -> float:
    return float(np.linalg.norm(frame.camera_to_world.translation - here))


def _difference(camera: PinholeCamera, view_pairs: _ViewPairs, scale: float) -> float:
    """By how much second views differ from first ones, relatively, if depth is scaled."""
    stride = max(camera.width // _COLUMNS, 1)
    found = [np.zeros(0)]
    for first_to_second, depth, second in view_pairs:
        rows, columns = stride * np.array(np.nonzero(depth[::stride, ::stride] > 0.0))
        points = camera.unproject_pixels(rows, columns, depth[rows, columns].astype(float) * scale)
        seen = first_to_second.apply(points)
        seen = seen[seen[:, 2] > 0.0]
        u, v = np.floor(camera.project(seen)).T
        inside = (u >= 0) & (u < camera.width) & (v >= 0) & (v < camera.height)
        u, v, expected = u[inside].astype(int), v[inside].astype(int), seen[inside, 2]
        measured = second[v, u] * scale
        found.append(np.abs(np.log(expected[measured > 0.0] / measured[measured > 0.0])))
    differences = np.concatenate(found)
    return float(np.median(differences)) if differences.size >= _LEAST_POINTS else math.inf


def _misfit(returns: Float32[np.ndarray, " n"]) -> str | None:
    near_m, half_m, far_m = np.quantile(returns, [0.1, 0.5, 0.9])
    if far_m < _NEAR_M[0] or half_m < _NEAR_M[1]:
        return "nearer"
    return "farther" if near_m > _FAR_M[0] or half_m > _FAR_M[1] else None


_ROUNDING = 1e-9
"""Largest difference of equal numbers in poses."""
_FEWEST_STEPS, _LEAST_JUMP_M, _JUMP = 5, 0.5, 3.0
"""What is a jump: at least this number of steps, metres, and times the longest step."""


def without_lost_poses(recording: Recording) -> Recording:
    """The recording without the frames that the identity marks as lost, and with what is odd noted.

    Args:
        recording: A recording.
    """
    total = len(recording.frames)
    is_identity = [_is_identity(frame) for frame in recording.frames]
    begin = is_identity.index(False) if False in is_identity else total
    moving = [k for k in range(begin, total) if not is_identity[k]]
    standing = [] if _jumps([recording.frames[k] for k in moving]) else list(range(begin))
    frames: list[RecordedFrame] = [recording.frames[k] for k in (*standing, *moving)]
    why = "their pose is exactly the identity, where the camera is not, so it was lost"
    notes = [*recording.notes, *left_out(total - len(frames), total, "frames", why)]
    if not moving and total > 1:
        notes.append(
            f"the poses of all {total} frames are exactly the identity: the camera stood still, or "
            "its poses are missing"
        )
    return replace(recording, frames=frames, notes=notes)


def _jumps(frames: Sequence[RecordedFrame]) -> bool:
    """Whether the first of some frames lies far from the origin for steps as long as theirs."""
    places = np.array([frame.camera_to_world.translation for frame in frames]).reshape(-1, 3)
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    if len(steps) < _FEWEST_STEPS:
        return False
    return bool(np.linalg.norm(places[0]) > max(_LEAST_JUMP_M, _JUMP * steps.max()))


def _is_identity(frame: RecordedFrame) -> bool:
    return bool(np.abs(frame.camera_to_world.matrix - np.eye(4)).max() <= _ROUNDING)


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
"""What recordings of other formats are, and how to make one that is read."""
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
        if not path.is_dir():
            check_file(path, most=sys.maxsize)
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
