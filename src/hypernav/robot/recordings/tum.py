"""Recordings in the format of the TUM RGB-D benchmark.

``rgb.txt``, ``depth.txt`` (lines ``time file``) and ``groundtruth.txt`` (camera to world,
``time x y z qx qy qz qw``); a depth value of 5000 is one metre. The format has no file for the
camera; ``camera.txt`` with ``fx fy cx cy`` is read if it exists, else the benchmark's nominal
values are used.

Source: https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats
"""

from pathlib import Path

import numpy as np
from jaxtyping import Float64
from scipy.spatial.transform import Rotation

from hypernav.core.errors import RecordingError
from hypernav.core.files.image_sizes import image_size
from hypernav.core.files.reading import path_below, read_file
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Transform
from hypernav.robot.recordings.frame_files import (
    FrameFiles,
    read_lines,
    read_numbers,
    recording_of_files,
)
from hypernav.robot.recordings.recording import Recording

_APART_S = 0.02
"""Largest difference of matching times, as in the benchmark's own tools."""
_NOMINAL = (525.0, 525.0, 319.5, 239.5)


def is_tum(folder: Path) -> bool:
    """Whether a folder holds such a recording."""
    return (folder / "groundtruth.txt").is_file() and (folder / "rgb.txt").is_file()


def read_tum(folder: Path) -> Recording:
    """Read everything but the images.

    Raises:
        RecordingError: A file is missing or broken, or no times match.
    """
    colours, depths = (_listed(folder, f"{name}.txt") for name in ("rgb", "depth"))
    stamps, poses = _poses(folder / "groundtruth.txt")
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
    return recording_of_files(folder.name, _camera(folder, frames[0].colour), 5000.0, frames)


def _listed(folder: Path, name: str) -> list[tuple[float, Path]]:
    found = []
    for line in read_lines(folder / name):
        try:
            stamp, file = line.split()
            found.append((float(stamp), path_below(folder, file)))
        except (ValueError, OSError) as error:
            raise RecordingError(f"{folder / name}: '{line:.60}': {error}") from error
    if not found:
        raise RecordingError(f"{folder / name} lists no image")
    return found


def _poses(path: Path) -> tuple[Float64[np.ndarray, " n"], list[Transform]]:
    stamps, poses = [], []
    for line in read_lines(path):
        try:
            stamp, *numbers = map(float, line.split())
            rotation = Rotation.from_quat(numbers[3:]).as_matrix()
            poses.append(Transform(rotation, np.array(numbers[:3])))
            stamps.append(stamp)
        except ValueError as error:
            raise RecordingError(f"{path}: '{line:.60}': {error}") from error
    if not poses:
        raise RecordingError(f"{path} holds no pose")
    return np.array(stamps), poses


def _camera(folder: Path, first: Path) -> PinholeCamera:
    path = folder / "camera.txt"
    fx, fy, cx, cy = read_numbers(path, 4) if path.is_file() else _NOMINAL
    size = image_size(read_file(first))
    if size is None:
        raise RecordingError(f"{first}: expected a PNG or JPEG image")
    # The format measures from the centre of the first pixel, our cameras from its corner.
    return PinholeCamera(*size, fx, fy, cx + 0.5, cy + 0.5)
