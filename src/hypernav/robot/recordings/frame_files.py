"""Frames whose images are files, and the text files that come with them."""

import io
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from jaxtyping import Float32, UInt8
from PIL import Image

from hypernav.core.errors import RecordingError
from hypernav.core.files.image_sizes import MOST_PIXELS, image_size
from hypernav.core.files.reading import read_file
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Transform
from hypernav.robot.recordings.recording import RecordedFrame, Recording

_NO_RETURN = 65_535
"""Depth that 3DMatch's cameras write for pixels without a return, beside 0."""
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
    name: str, camera: PinholeCamera, depth_per_metre: float, frames: list[FrameFiles]
) -> Recording:
    """A recording whose images are read from files when they are asked for.

    Args:
        name: Name of the recording.
        camera: Intrinsics of both images.
        depth_per_metre: Depth value of one metre.
        frames: Frames in the order of time.
    """
    return Recording(
        name,
        camera,
        [
            RecordedFrame(
                frame.colour.name,
                frame.camera_to_world,
                frame.stamp_s,
                partial(_rgb, frame.colour, camera),
                partial(_depth, frame.depth, camera, depth_per_metre),
            )
            for frame in frames
        ],
    )


def read_lines(path: Path) -> list[str]:
    """The lines of a text file that are no comments.

    Raises:
        RecordingError: It cannot be read.
    """
    try:
        text = read_file(path).decode("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise RecordingError(f"{path} can't be read: {error}") from error
    return [line for line in text.splitlines() if line.strip() and not line.startswith("#")]


def read_numbers(path: Path, count: int) -> list[float]:
    """The numbers of a text file.

    Raises:
        RecordingError: The file cannot be read, or holds a different number of values.
    """
    try:
        numbers = [float(word) for line in read_lines(path) for word in line.split()]
    except ValueError as error:
        raise RecordingError(f"{path}: expected {count} numbers: {error}") from error
    if len(numbers) != count or not np.isfinite(numbers).all():
        raise RecordingError(f"{path}: expected {count} finite numbers, found {len(numbers)}")
    return numbers


def rigid(matrix: np.ndarray, path: Path) -> Transform:
    """A pose from a file.

    Raises:
        RecordingError: The matrix is no rigid transform.
    """
    rotation = matrix[:3, :3]
    if not np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-2):
        raise RecordingError(f"{path}: expected a rigid pose, its rotation is not orthonormal")
    # Rounding in the file must not bend the map.
    u, _, v = np.linalg.svd(rotation)
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = u @ v, matrix[:3, 3]
    return Transform.from_matrix(pose)


def _rgb(path: Path, camera: PinholeCamera) -> UInt8[np.ndarray, "height width 3"]:
    return _decoded(path, camera, lambda image: np.asarray(image.convert("RGB")))


def _depth(
    path: Path, camera: PinholeCamera, per_metre: float
) -> Float32[np.ndarray, "height width"]:
    values = _decoded(path, camera, lambda image: np.asarray(image))
    if values.ndim != 2:
        raise RecordingError(f"{path}: expected a grey image of 16 bits, found colours")
    metres = values.astype(np.float32) / np.float32(per_metre)
    return np.where(values == _NO_RETURN, np.float32(0.0), metres)


def _decoded(
    path: Path, camera: PinholeCamera, decode: Callable[[Image.Image], np.ndarray]
) -> np.ndarray:
    try:
        data = read_file(path)
        size = image_size(data)
        if size is None or size[0] * size[1] > MOST_PIXELS:
            raise RecordingError(f"{path}: expected a PNG or JPEG image")
        if size != (camera.width, camera.height):
            raise RecordingError(
                f"{path}: expected {camera.width} × {camera.height} pixels as in the first frame, "
                f"found {size[0]} × {size[1]}"
            )
        with Image.open(io.BytesIO(data)) as image:
            return decode(image)
    except _UNDECODABLE as error:
        raise RecordingError(f"{path} can't be read: {error}") from error
