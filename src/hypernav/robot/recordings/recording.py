"""A recording of an RGB-D camera, whatever its format."""

import io
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float32, UInt8
from PIL import Image

from hypernav.core.errors import RecordingError
from hypernav.core.files.image_sizes import MOST_PIXELS, image_size
from hypernav.core.files.reading import read_file
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Transform

_NO_RETURN = 65_535
"""Depth that 3DMatch's cameras write for pixels without a return, beside 0."""
_UNDECODABLE = (OSError, SyntaxError, ValueError, EOFError)


@dataclass(frozen=True, eq=False)
class RecordedFrame:
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


@dataclass(frozen=True, eq=False)
class Recording:
    """All frames of a recording, not yet read.

    Attributes:
        name: Name of its folder.
        camera: Intrinsics of both images.
        depth_per_metre: Depth value of one metre.
        frames: Frames in the order of time.
    """

    name: str
    camera: PinholeCamera
    depth_per_metre: float
    frames: Sequence[RecordedFrame]

    def rgb(self, frame: RecordedFrame) -> UInt8[np.ndarray, "height width 3"]:
        """The colour image of a frame.

        Raises:
            RecordingError: It cannot be read, or has another size than the camera.
        """
        return _decoded(frame.colour, self.camera, lambda i: np.asarray(i.convert("RGB")))

    def depth(self, frame: RecordedFrame) -> Float32[np.ndarray, "height width"]:
        """The depth image of a frame, metres; 0 where there is no return.

        Raises:
            RecordingError: It cannot be read, or has another size than the camera.
        """
        values = _decoded(frame.depth, self.camera, lambda image: np.asarray(image))
        if values.ndim != 2:
            raise RecordingError(f"{frame.depth}: expected a grey image of 16 bits, found colours")
        metres = values.astype(np.float32) / np.float32(self.depth_per_metre)
        return np.where(values == _NO_RETURN, np.float32(0.0), metres)


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
        RecordingError: It cannot be read, or holds another number of them.
    """
    try:
        numbers = [float(word) for line in read_lines(path) for word in line.split()]
    except ValueError as error:
        raise RecordingError(f"{path}: expected {count} numbers: {error}") from error
    if len(numbers) != count or not np.isfinite(numbers).all():
        raise RecordingError(f"{path}: expected {count} finite numbers, found {len(numbers)}")
    return numbers


def rigid(matrix: np.ndarray, path: Path) -> Transform:
    """A pose out of a file.

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
