"""Colour and depth out of ``sensor_msgs/Image`` and ``sensor_msgs/CompressedImage``.

Messages are objects with the fields of the ROS type, made by any library.

Sources: sensor_msgs, ``image_encodings.hpp``; REP 118 (depth images); ``compression_common.hpp`` of
compressed_depth_image_transport.
"""

import io
import struct
from enum import StrEnum
from typing import Any

import numpy as np
from jaxtyping import Float32, UInt8
from PIL import Image

from hypernav.core.errors import RosMessageError
from hypernav.core.files.image_sizes import MOST_PIXELS, image_size

_COLOURS = {
    "rgb8": (3, (0, 1, 2)),
    "bgr8": (3, (2, 1, 0)),
    "rgba8": (4, (0, 1, 2)),
    "bgra8": (4, (2, 1, 0)),
    "8UC3": (3, (2, 1, 0)),
}
"""Bytes per pixel, and which of them are red, green and blue."""
_DEPTHS = {"16UC1": np.uint16, "mono16": np.uint16, "32FC1": np.float32}
_PER_METRE = np.float32(1000.0)
_COMPRESSED_DEPTH = "compressedDepth"
_DEPTH_HEADER = struct.Struct("<Iff")
"""Kind of the compression, and the two parameters of quantised inverse depth."""
_UNDECODABLE = (OSError, SyntaxError, ValueError, EOFError)


class ImageKind(StrEnum):
    """What the pixels of an image are."""

    COLOUR = "colour"
    DEPTH = "depth"


def kind_of(message: Any) -> ImageKind | None:
    """Whether an image is colour or depth; None if it is neither, for example grey."""
    encoding = _encoding(message)
    if encoding in _DEPTHS:
        return ImageKind.DEPTH
    if encoding in _COLOURS or (_is_compressed(message) and encoding in ("jpeg", "png", "jpg")):
        return ImageKind.COLOUR
    return None


def colour_of(message: Any) -> UInt8[np.ndarray, "height width 3"]:
    """The colour image of a message.

    Raises:
        RosMessageError: The message holds no colour image, or a broken one.
    """
    encoding = _encoding(message)
    if kind_of(message) is not ImageKind.COLOUR:
        raise RosMessageError(
            f"expected a colour image ({', '.join(_COLOURS)}, JPEG or PNG), found '{encoding:.40}'"
        )
    if _is_compressed(message):
        return _decoded(bytes(message.data), "RGB")
    size, order = _COLOURS[encoding]
    pixels = _pixels(message, np.dtype(np.uint8), size)
    return np.ascontiguousarray(pixels[:, :, list(order)])


def depth_of(message: Any) -> Float32[np.ndarray, "height width"]:
    """The depth image of a message, metres along the optical axis; 0 where there is no return.

    Raises:
        RosMessageError: The message holds no depth image, or a broken one.
    """
    encoding = _encoding(message)
    if kind_of(message) is not ImageKind.DEPTH:
        raise RosMessageError(
            f"expected a depth image (16UC1 in millimetres or 32FC1 in metres), found "
            f"'{encoding:.40}'"
        )
    if _is_compressed(message):
        return _decompressed_depth(message, encoding)
    values = _pixels(message, np.dtype(_DEPTHS[encoding]), 1)[:, :, 0]
    if values.dtype.kind == "f":
        # REP 118: NaN and infinities are pixels without a return.
        return np.where(np.isfinite(values), values, np.float32(0.0)).astype(np.float32)
    return values.astype(np.float32) / _PER_METRE


def _encoding(message: Any) -> str:
    if _is_compressed(message):
        # "jpeg", "rgb8; jpeg compressed bgr8", "16UC1; compressedDepth png"
        return message.format.split(";")[0].strip()
    return message.encoding


def _is_compressed(message: Any) -> bool:
    return hasattr(message, "format")


def _pixels(message: Any, dtype: np.dtype, channels: int) -> np.ndarray:
    """The pixels ``[row, column, channel]`` of an uncompressed image."""
    height, width, step = message.height, message.width, message.step
    row_bytes = width * channels * dtype.itemsize
    if not (0 < height * width <= MOST_PIXELS and step >= row_bytes):
        raise RosMessageError(
            f"expected an image of at most {MOST_PIXELS:,} pixels whose rows hold {row_bytes} "
            f"bytes, found {width} × {height} pixels and rows of {step} bytes"
        )
    data = np.frombuffer(message.data, dtype=np.uint8)
    if data.size < height * step:
        raise RosMessageError(f"an image of {height * step} bytes ends after {data.size}")
    rows = np.ascontiguousarray(data[: height * step].reshape(height, step)[:, :row_bytes])
    ordered = dtype.newbyteorder(">" if message.is_bigendian else "<")
    return rows.view(ordered).astype(dtype, copy=False).reshape(height, width, channels)


def _decompressed_depth(message: Any, encoding: str) -> Float32[np.ndarray, "height width"]:
    data = bytes(message.data)
    if _COMPRESSED_DEPTH not in message.format:
        return _decoded(data, "I;16").astype(np.float32) / _PER_METRE
    if message.format.rstrip().endswith("rvl"):
        raise RosMessageError(
            "cannot read depth compressed by RVL; use the raw topic or compressedDepth with PNG"
        )
    if len(data) < _DEPTH_HEADER.size:
        raise RosMessageError(f"a compressed depth image ends after {len(data)} bytes")
    _, near, far = _DEPTH_HEADER.unpack_from(data)
    values = _decoded(data[_DEPTH_HEADER.size :], "I;16").astype(np.float32)
    if encoding != "32FC1":
        return values / _PER_METRE
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = np.float32(near) / (values - np.float32(far))
    return np.where((values > 0.0) & np.isfinite(depth), depth, np.float32(0.0))


def _decoded(data: bytes, mode: str) -> np.ndarray:
    """An image from the bytes of a PNG or JPEG file."""
    size = image_size(data)
    if size is None or not 0 < size[0] * size[1] <= MOST_PIXELS:
        raise RosMessageError("expected a PNG or JPEG image of moderate size in the message")
    try:
        with Image.open(io.BytesIO(data)) as image:
            if mode == "RGB":
                return np.asarray(image.convert(mode))
            if not image.mode.startswith("I"):
                raise RosMessageError(
                    f"expected a depth image of 16 bits, found the mode {image.mode}"
                )
            return np.asarray(image)
    except _UNDECODABLE as error:
        raise RosMessageError(f"an image can't be decoded: {error}") from error
