"""Frames whose images are files, and the text files that come with them."""

import io
import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from jaxtyping import Float32, UInt8
from PIL import Image

from hypernav.core.errors import CameraError, RecordingError
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Transform
from hypernav.io.reading import MOST_PIXELS, image_size, read_file, text_of
from hypernav.robot.recordings.recording import RecordedFrame, Recording

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
