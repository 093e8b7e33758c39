"""Recordings as ScanNet's SensReader unpacks them.

``color/0.jpg``, ``depth/0.png`` (millimetres), ``pose/0.txt`` (camera to world, 4 × 4), and
``intrinsic/intrinsic_depth.txt`` (4 × 4). Colour is larger than depth, and shows the same.

Source: https://github.com/ScanNet/ScanNet/tree/master/SensReader/python
"""

from pathlib import Path

from hypernav.core.errors import RecordingError
from hypernav.robot.recordings.frame_files import (
    FrameFiles,
    camera_of,
    read_numbers,
    read_pose,
    recording_of_files,
)
from hypernav.robot.recordings.recording import Recording, left_out

_FOLDERS = ("color", "depth", "pose")


def is_scannet(folder: Path) -> bool:
    """Whether a folder holds such a recording."""
    return all((folder / name).is_dir() for name in _FOLDERS)


def read_scannet(folder: Path) -> Recording:
    """Read everything but the images.

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
