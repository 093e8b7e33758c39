"""Recordings in the format of the TUM RGB-D benchmark.

``rgb.txt``, ``depth.txt`` (lines ``time file``) and ``groundtruth.txt`` (camera to world,
``time x y z qx qy qz qw``); a depth value of 5000 is one metre. The format has no file for the
camera; ``camera.txt`` with ``fx fy cx cy`` is read if it exists, else the benchmark's nominal
values are used.

Source: https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats
"""

import math
from pathlib import Path

import numpy as np
from jaxtyping import Float64
from scipy.spatial.transform import Rotation

from hypernav.core.errors import RecordingError
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Transform
from hypernav.io.reading import path_below
from hypernav.robot.recordings.frame_files import (
    FrameFiles,
    broken_line,
    camera_of,
    number_of,
    read_lines,
    read_numbers,
    recording_of_files,
)
from hypernav.robot.recordings.recording import Recording, left_out

_APART_S = 0.02
"""Largest difference of matching times, as in the benchmark's own tools."""
_YEAR_1973_S = 1e8
"""A time below it counts seconds: no recording is so old, and none so long."""
_NEEDED = {
    "depth.txt": "the depth images, one line 'time file' each",
    "groundtruth.txt": "the poses, one line 'time x y z qx qy qz qw' each, as SLAM programs write "
    "them (ORB-SLAM: CameraTrajectory.txt)",
}
_NOMINAL, _NOMINAL_SIZE = (525.0, 525.0, 319.5, 239.5), (640, 480)


def is_tum(folder: Path) -> bool:
    """Whether a folder holds such a recording."""
    return (folder / "rgb.txt").is_file()


def read_tum(folder: Path) -> Recording:
    """Read everything but the images.

    Raises:
        RecordingError: A file is missing or broken, or no times match.
    """
    for name, what in _NEEDED.items():
        if not (folder / name).is_file():
            raise RecordingError(f"{folder}: expected {name} beside rgb.txt: {what}")
    colours, depths = (_listed(folder, f"{name}.txt") for name in ("rgb", "depth"))
    stamps, poses, notes = _poses(folder / "groundtruth.txt")
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
    camera = _camera(folder, frames[0].colour)
    return recording_of_files(folder.name, camera, 5000.0, frames, notes)


def _listed(folder: Path, name: str) -> list[tuple[float, Path]]:
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


def _poses(path: Path) -> tuple[Float64[np.ndarray, " n"], list[Transform], list[str]]:
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


def _camera(folder: Path, first: Path) -> PinholeCamera:
    path = folder / "camera.txt"
    fx, fy, cx, cy = read_numbers(path, 4) if path.is_file() else _NOMINAL
    camera = camera_of((fx, fy, cx, cy), path, first)
    if not path.is_file() and (camera.width, camera.height) != _NOMINAL_SIZE:
        raise RecordingError(
            f"{folder}: the benchmark's camera has images of 640 × 480 pixels, these have "
            f"{camera.width} × {camera.height}; write fx fy cx cy of yours into camera.txt"
        )
    return camera
