"""Recordings whose images are files: TUM RGB-D, 3DMatch, 7-Scenes and ScanNet."""

import io
import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from jaxtyping import Float32, Float64, UInt8
from PIL import Image
from scipy.spatial.transform import Rotation

from hypernav.core.errors import CameraError, RecordingError
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Transform
from hypernav.io.reading import MOST_PIXELS, image_size, path_below, read_file, text_of
from hypernav.robot.recordings.recording import RecordedFrame, Recording, left_out

_NO_RETURN = 65_535
"""Depth that 3DMatch's cameras write for pixels without a return, beside 0."""
_UNKNOWN = re.compile(r"[+-]?\d\.#(IND|INF|QNAN|SNAN)\d*", re.IGNORECASE)
_UNDECODABLE = (OSError, SyntaxError, ValueError, EOFError)


@dataclass(frozen=True, eq=False)
class FrameFiles:
    """One frame on disk.

    Attributes:
        colour: File of the colour image.
        depth: File of the depth image, 16-bit grey.
        camera_to_world: Pose of the camera; the world is the recording's own.
        stamp_s: Time of the frame, seconds; its number where no time is known.
    """

    colour: Path
    depth: Path
    camera_to_world: Transform
    stamp_s: float


def recording_of_files(
    name: str,
    camera: PinholeCamera,
    depth_per_metre: float,
    frames: list[FrameFiles],
    notes: list[str],
    *,
    resizes: bool = False,
) -> Recording:
    """A recording whose images are read from files when they are asked for.

    Args:
        name: Name of the recording.
        camera: Intrinsics of both images.
        depth_per_metre: Depth value of one metre.
        frames: Frames in the order of time.
        notes: What a user should know about it.
        resizes: Whether colour of another size shows the same, and is brought to that of depth.
    """
    return Recording(
        name,
        camera,
        [
            RecordedFrame(
                frame.colour.name,
                frame.camera_to_world,
                frame.stamp_s,
                partial(_rgb, frame.colour, camera, resizes),
                partial(_depth, frame.depth, camera, depth_per_metre),
            )
            for frame in frames
        ],
        depth_per_metre,
        notes,
    )


def read_lines(path: Path) -> list[tuple[int, str]]:
    """The lines of a text file that are no comments, with their numbers from 1.

    Raises:
        RecordingError: It cannot be read.
    """
    try:
        text = text_of(read_file(path))
    except (OSError, UnicodeDecodeError) as error:
        raise RecordingError(f"{path} can't be read: {error}") from error
    lines = enumerate(text.splitlines(), start=1)
    return [(at, line) for at, line in lines if line.strip() and not line.startswith("#")]


def broken_line(path: Path, at: int, line: str, expected: str) -> RecordingError:
    """The error that names a line which is not as its format says.

    Args:
        path: The file.
        at: Number of the line, from 1.
        line: The line.
        expected: What the format says.
    """
    commas = "; write spaces for its commas" if "," in line else ""
    return RecordingError(f"{path}, line {at}: expected {expected}, found '{line:.60}'{commas}")


def number_of(word: str) -> float:
    """The number that a word means; NaN also as Microsoft's libraries write it (``-1.#IND00``).

    Raises:
        ValueError: It is no number.
    """
    return math.nan if _UNKNOWN.fullmatch(word) else float(word)


def read_numbers(path: Path, count: int) -> list[float]:
    """The numbers of a text file, which may be infinite or NaN.

    Raises:
        RecordingError: The file cannot be read, or holds a different number of values.
    """
    numbers: list[float] = []
    for at, line in read_lines(path):
        try:
            numbers += map(number_of, line.split())
        except ValueError as error:
            raise broken_line(path, at, line, f"{count} numbers in all") from error
    if len(numbers) != count:
        raise RecordingError(f"{path}: expected {count} numbers, found {len(numbers)}")
    return numbers


def camera_of(numbers: tuple[float, float, float, float], path: Path, first: Path) -> PinholeCamera:
    """The camera of a recording.

    Args:
        numbers: Its ``fx fy cx cy``, measured from the centre of the first pixel.
        path: File that says them.
        first: The first colour image.

    Raises:
        RecordingError: They are no camera, or the image can't be read.
    """
    try:
        size = image_size(read_file(first))
    except OSError as error:
        raise RecordingError(f"{first} can't be read: {error.strerror or error}") from error
    if size is None:
        raise RecordingError(f"{first}: expected a PNG or JPEG image")
    fx, fy, cx, cy = numbers
    try:
        # Our cameras measure from the corner of the first pixel.
        return PinholeCamera(*size, fx, fy, cx + 0.5, cy + 0.5)
    except CameraError as error:
        raise RecordingError(f"{path}: {error}") from error


def read_pose(path: Path) -> Transform | None:
    """The pose in a file of 16 numbers.

    Returns:
        None where the camera was lost: an empty file, no finite numbers, or no rotation.

    Raises:
        RecordingError: The file cannot be read, or its matrix is no rigid transform.
    """
    if not read_lines(path):
        return None
    matrix = np.array(read_numbers(path, 16)).reshape(4, 4)
    rotation = matrix[:3, :3]
    if not np.isfinite(matrix).all() or not rotation.any():
        return None
    if not np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-2):
        raise RecordingError(f"{path}: expected a rigid pose, its rotation is not orthonormal")
    # Rounding in the file must not bend the map.
    u, _, v = np.linalg.svd(rotation)
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = u @ v, matrix[:3, 3]
    return Transform.from_matrix(pose)


def _rgb(path: Path, camera: PinholeCamera, resizes: bool) -> UInt8[np.ndarray, "height width 3"]:
    def decode(image: Image.Image) -> np.ndarray:
        rgb, size = image.convert("RGB"), (camera.width, camera.height)
        return np.asarray(rgb if rgb.size == size else rgb.resize(size, Image.Resampling.BOX))

    return _decoded(path, None if resizes else camera, decode)


def _depth(
    path: Path, camera: PinholeCamera, per_metre: float
) -> Float32[np.ndarray, "height width"]:
    values = _decoded(path, camera, lambda image: np.asarray(image))
    if values.ndim != 2:
        raise RecordingError(f"{path}: expected a grey image of 16 bits, found colours")
    metres = values.astype(np.float32) / np.float32(per_metre)
    return np.where(values == _NO_RETURN, np.float32(0.0), metres)


def _decoded(
    path: Path, camera: PinholeCamera | None, decode: Callable[[Image.Image], np.ndarray]
) -> np.ndarray:
    try:
        data = read_file(path)
        size = image_size(data)
        if size is None or size[0] * size[1] > MOST_PIXELS:
            raise RecordingError(f"{path}: expected a PNG or JPEG image")
        if camera is not None and size != (camera.width, camera.height):
            raise RecordingError(
                f"{path}: expected {camera.width} × {camera.height} pixels as in the first frame, "
                f"found {size[0]} × {size[1]}"
            )
        with Image.open(io.BytesIO(data)) as image:
            return decode(image)
    except _UNDECODABLE as error:
        raise RecordingError(f"{path} can't be read: {error}") from error


_APART_S = 0.02
"""Largest difference of matching times, as in the benchmark's own tools."""
_YEAR_1973_S = 1e8
"""A time below it counts seconds: no recording is so old, and none so long."""
_TUM_NEEDED = {
    "depth.txt": "the depth images, one line 'time file' each",
    "groundtruth.txt": "the poses, one line 'time x y z qx qy qz qw' each, as SLAM programs write "
    "them (ORB-SLAM: CameraTrajectory.txt)",
}
_TUM_NOMINAL, _TUM_NOMINAL_SIZE = (525.0, 525.0, 319.5, 239.5), (640, 480)


def is_tum(folder: Path) -> bool:
    """Whether a folder holds such a recording."""
    return (folder / "rgb.txt").is_file()


def read_tum(folder: Path) -> Recording:
    """Read everything but the images of a recording in the format of the TUM RGB-D benchmark.

    ``rgb.txt``, ``depth.txt`` (lines ``time file``) and ``groundtruth.txt`` (camera to world,
    ``time x y z qx qy qz qw``); a depth value of 5000 is one metre. The format has no file for the
    camera; ``camera.txt`` with ``fx fy cx cy`` is read if it exists, else the benchmark's nominal
    values are used.

    Source: https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats

    Raises:
        RecordingError: A file is missing or broken, or no times match.
    """
    for name, what in _TUM_NEEDED.items():
        if not (folder / name).is_file():
            raise RecordingError(f"{folder}: expected {name} beside rgb.txt: {what}")
    colours, depths = (_tum_images(folder, f"{name}.txt") for name in ("rgb", "depth"))
    stamps, poses, notes = _tum_poses(folder / "groundtruth.txt")
    depth_stamps = np.array([stamp for stamp, _ in depths])
    frames = []
    for stamp, colour in colours:
        near, at = (int(np.abs(times - stamp).argmin()) for times in (depth_stamps, stamps))
        if max(abs(depth_stamps[near] - stamp), abs(stamps[at] - stamp)) <= _APART_S:
            frames.append(FrameFiles(colour, depths[near][1], poses[at], stamp))
    if not frames:
        raise RecordingError(
            f"{folder}: no colour image has a depth image and a pose within {_APART_S:g} s"
        )
    why = f"without a depth image or a pose within {_APART_S:g} s"
    notes += left_out(len(colours) - len(frames), len(colours), "colour images", why)
    camera = _tum_camera(folder, frames[0].colour)
    return recording_of_files(folder.name, camera, 5000.0, frames, notes)


def _tum_images(folder: Path, name: str) -> list[tuple[float, Path]]:
    found = []
    for at, line in read_lines(folder / name):
        try:
            stamp, file = line.split()
            found.append((_seconds(stamp), path_below(folder, file)))
        except ValueError as error:
            raise broken_line(folder / name, at, line, "'time file'") from error
        except OSError as error:
            raise RecordingError(f"{folder / name}, line {at}: '{line:.60}': {error}") from error
    if not found:
        raise RecordingError(f"{folder / name} lists no image")
    return found


def _tum_poses(path: Path) -> tuple[Float64[np.ndarray, " n"], list[Transform], list[str]]:
    """Times and poses, and the note about those that are none."""
    stamps, poses, lines = [], [], read_lines(path)
    for at, line in lines:
        try:
            stamp, *numbers = line.split()
            x, y, z, qx, qy, qz, qw = map(number_of, numbers)
            at_s, quaternion = _seconds(stamp), (qx, qy, qz, qw)
            if not any(quaternion) or not np.isfinite([x, y, z, *quaternion]).all():
                continue  # the camera was lost
            rotation = Rotation.from_quat(quaternion).as_matrix()
        except ValueError as error:
            raise broken_line(path, at, line, "the numbers 'time x y z qx qy qz qw'") from error
        poses.append(Transform(rotation, np.array([x, y, z])))
        stamps.append(at_s)
    if not poses:
        raise RecordingError(f"{path} holds no pose")
    notes = left_out(len(lines) - len(poses), len(lines), f"poses of {path.name}", "not valid")
    return np.array(stamps), poses, notes


def _seconds(stamp: str) -> float:
    """A time in seconds, from whichever part of a second since 1970 it counts."""
    value = float(stamp)
    if not math.isfinite(value):
        raise ValueError(f"{stamp} is no time")
    return next((value / unit for unit in (1e9, 1e6, 1e3) if value > unit * _YEAR_1973_S), value)


def _tum_camera(folder: Path, first: Path) -> PinholeCamera:
    path = folder / "camera.txt"
    fx, fy, cx, cy = read_numbers(path, 4) if path.is_file() else _TUM_NOMINAL
    camera = camera_of((fx, fy, cx, cy), path, first)
    if not path.is_file() and (camera.width, camera.height) != _TUM_NOMINAL_SIZE:
        raise RecordingError(
            f"{folder}: the benchmark's camera has images of 640 × 480 pixels, these have "
            f"{camera.width} × {camera.height}; write fx fy cx cy of yours into camera.txt"
        )
    return camera


_INTRINSICS = "camera-intrinsics.txt"
_MATCHED_POSES = "frame-*.pose.txt"


def is_matched_frames(folder: Path) -> bool:
    """Whether a folder holds such a recording."""
    return next(folder.glob(_MATCHED_POSES), None) is not None


def read_matched_frames(folder: Path) -> Recording:
    """Read everything but the images of a recording as in 3DMatch and 7-Scenes.

    ``frame-000000.color.png``, ``frame-000000.depth.png`` (millimetres) and
    ``frame-000000.pose.txt`` (camera to world, 4 × 4), with ``camera-intrinsics.txt`` (3 × 3) in
    the folder or the one above.

    Raises:
        RecordingError: A file is missing or broken.
    """
    frames: list[FrameFiles] = []
    paths = sorted(folder.glob(_MATCHED_POSES))
    for path in paths:
        pose = read_pose(path)
        if pose is None:
            continue
        stem = path.name.removesuffix(".pose.txt")
        colour = next((f for f in sorted(folder.glob(f"{stem}.color.*"))), None)
        depth = folder / f"{stem}.depth.png"
        if colour is None or not depth.is_file():
            raise RecordingError(f"{folder}: {stem} has a pose, but no colour or no depth image")
        frames.append(FrameFiles(colour, depth, pose, float(len(frames))))
    if not frames:
        raise RecordingError(f"{folder}: no frame has a valid pose")
    notes = left_out(len(paths) - len(frames), len(paths), "frames", "they have no valid pose")
    camera = _matched_frames_camera(folder, frames[0].colour)
    return recording_of_files(folder.name, camera, 1000.0, frames, notes)


def _matched_frames_camera(folder: Path, first: Path) -> PinholeCamera:
    path = next(
        (p for p in (folder / _INTRINSICS, folder.parent / _INTRINSICS) if p.is_file()), None
    )
    if path is None:
        raise RecordingError(
            f"{folder}: expected {_INTRINSICS} in it or in the folder above: the nine numbers of "
            "the camera matrix"
        )
    fx, _, cx, _, fy, cy, *_ = read_numbers(path, 9)
    return camera_of((fx, fy, cx, cy), path, first)


_SCANNET_FOLDERS = ("color", "depth", "pose")


def is_scannet(folder: Path) -> bool:
    """Whether a folder holds such a recording."""
    return all((folder / name).is_dir() for name in _SCANNET_FOLDERS)


def read_scannet(folder: Path) -> Recording:
    """Read everything but the images of a recording as ScanNet's SensReader unpacks it.

    ``color/0.jpg``, ``depth/0.png`` (millimetres), ``pose/0.txt`` (camera to world, 4 × 4), and
    ``intrinsic/intrinsic_depth.txt`` (4 × 4). Colour is larger than depth, and shows the same.

    Source: https://github.com/ScanNet/ScanNet/tree/master/SensReader/python

    Raises:
        RecordingError: A file is missing or broken.
    """
    poses = [path for path in (folder / "pose").glob("*.txt") if path.stem.isdecimal()]
    frames: list[FrameFiles] = []
    for path in sorted(poses, key=lambda path: int(path.stem)):
        pose = read_pose(path)
        if pose is None:
            continue
        colour = next((folder / "color").glob(f"{path.stem}.*"), None)
        depth = folder / "depth" / f"{path.stem}.png"
        if colour is None or not depth.is_file():
            raise RecordingError(f"{path}: has a pose, but no colour or no depth image")
        frames.append(FrameFiles(colour, depth, pose, float(path.stem)))
    if not frames:
        raise RecordingError(f"{folder / 'pose'}: no frame has a valid pose")
    intrinsics = folder / "intrinsic" / "intrinsic_depth.txt"
    fx, _, cx, _, _, fy, cy, *_ = read_numbers(intrinsics, 16)
    camera = camera_of((fx, fy, cx, cy), intrinsics, frames[0].depth)
    notes = left_out(len(poses) - len(frames), len(poses), "frames", "they have no valid pose")
    return recording_of_files(folder.name, camera, 1000.0, frames, notes, resizes=True)
