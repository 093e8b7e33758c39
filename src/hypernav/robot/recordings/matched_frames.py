"""Recordings in the format of 3DMatch and 7-Scenes: a file of its own for every image and pose.

``frame-000000.color.png``, ``frame-000000.depth.png`` (millimetres) and ``frame-000000.pose.txt``
(camera to world, 4 × 4), with ``camera-intrinsics.txt`` (3 × 3) in the folder or the one above.
"""

from pathlib import Path

from hypernav.core.errors import RecordingError
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.robot.recordings.frame_files import (
    FrameFiles,
    camera_of,
    read_numbers,
    read_pose,
    recording_of_files,
)
from hypernav.robot.recordings.recording import Recording, left_out

_INTRINSICS = "camera-intrinsics.txt"
_POSES = "frame-*.pose.txt"


def is_matched_frames(folder: Path) -> bool:
    """Whether a folder holds such a recording."""
    return next(folder.glob(_POSES), None) is not None


def read_matched_frames(folder: Path) -> Recording:
    """Read everything but the images.

    Raises:
        RecordingError: A file is missing or broken.
    """
    frames: list[FrameFiles] = []
    paths = sorted(folder.glob(_POSES))
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
    camera = _camera(folder, frames[0].colour)
    return recording_of_files(folder.name, camera, 1000.0, frames, notes)


def _camera(folder: Path, first: Path) -> PinholeCamera:
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
