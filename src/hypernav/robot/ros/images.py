"""Colour and depth out of ``sensor_msgs/Image`` and ``sensor_msgs/CompressedImage``.

Messages are objects with the fields of the ROS type, made by any library.

Sources: sensor_msgs, ``image_encodings.hpp``; REP 118 (depth images); ``compression_common.hpp`` of
compressed_depth_image_transport.
"""

import io
import struct
from collections.abc import Mapping
from enum import StrEnum
from typing import Any

import cv2
import numpy as np
from jaxtyping import Float32, UInt8
from PIL import Image

from hypernav.core.errors import RosMessageError
from hypernav.io.reading import MOST_PIXELS, image_size

_COLOURS: Mapping[str, tuple[type[np.uint8 | np.uint16], int, int | None]] = {
    "rgb8": (np.uint8, 3, None),
    "bgr8": (np.uint8, 3, cv2.COLOR_BGR2RGB),
    "rgba8": (np.uint8, 4, cv2.COLOR_RGBA2RGB),
    "bgra8": (np.uint8, 4, cv2.COLOR_BGRA2RGB),
    "rgb16": (np.uint16, 3, None),
    "bgr16": (np.uint16, 3, cv2.COLOR_BGR2RGB),
    "rgba16": (np.uint16, 4, cv2.COLOR_RGBA2RGB),
    "bgra16": (np.uint16, 4, cv2.COLOR_BGRA2RGB),
    "8UC3": (np.uint8, 3, cv2.COLOR_BGR2RGB),
    "8UC4": (np.uint8, 4, cv2.COLOR_BGRA2RGB),
    "mono8": (np.uint8, 1, cv2.COLOR_GRAY2RGB),
    "8UC1": (np.uint8, 1, cv2.COLOR_GRAY2RGB),
    "uyvy": (np.uint8, 2, cv2.COLOR_YUV2RGB_UYVY),
    "yuv422": (np.uint8, 2, cv2.COLOR_YUV2RGB_UYVY),
    "yuyv": (np.uint8, 2, cv2.COLOR_YUV2RGB_YUY2),
    "yuv422_yuy2": (np.uint8, 2, cv2.COLOR_YUV2RGB_YUY2),
    "nv12": (np.uint8, 1, cv2.COLOR_YUV2RGB_NV12),
    "nv21": (np.uint8, 1, cv2.COLOR_YUV2RGB_NV21),
    "nv24": (np.uint8, 1, cv2.COLOR_YUV2RGB_NV12),
} | {
    f"bayer_{order}{8 * dtype().itemsize}": (dtype, 1, code)
    for order, code in {
        "rggb": cv2.COLOR_BayerRGGB2RGB,
        "bggr": cv2.COLOR_BayerBGGR2RGB,
        "gbrg": cv2.COLOR_BayerGBRG2RGB,
        "grbg": cv2.COLOR_BayerGRBG2RGB,
    }.items()
    for dtype in (np.uint8, np.uint16)
}
"""For every encoding the type and number of a pixel's values, and OpenCV's conversion to RGB."""
_PLANAR = ("nv12", "nv21", "nv24")
"""Encodings with the chroma of all pixels behind their brightness."""
_FILES = ("jpeg", "jpg", "png")
_GREY = ("mono8", "8UC1", "mono16")
_DEPTHS = {"16UC1": np.uint16, "mono16": np.uint16, "32FC1": np.float32}
_COMPRESSED_DEPTH = "compressedDepth"
_DEPTH_HEADER = struct.Struct("<Iff")
"""Kind of the compression, and the two parameters of quantised inverse depth."""
_UNDECODABLE = (OSError, SyntaxError, ValueError, EOFError)


class ImageKind(StrEnum):
    """What the pixels of an image are."""

    COLOUR = "colour"
    DEPTH = "depth"


def kind_of(message: Any) -> ImageKind | None:
    """Whether an image is colour or depth; None if its encoding can't be read."""
    encoding = encoding_of(message)
    if encoding in _DEPTHS:
        return ImageKind.DEPTH
    if encoding in _COLOURS or (_is_compressed(message) and encoding in _FILES):
        return ImageKind.COLOUR
    return None


def is_grey(message: Any) -> bool:
    """Whether an image may be infrared, though it has the encoding of colour or depth."""
    return encoding_of(message) in _GREY


def colour_of(message: Any) -> UInt8[np.ndarray, "height width 3"]:
    """The colour image of a message.

    Raises:
        RosMessageError: The message holds no colour image, or a broken one.
    """
    encoding = encoding_of(message)
    if kind_of(message) is not ImageKind.COLOUR:
        raise RosMessageError(
            f"expected a colour image, found '{encoding:.40}'; read are {readable_encodings()}"
        )
    if _is_compressed(message):
        return _decompressed_colour(message, encoding)
    dtype, channels, code = _COLOURS[encoding]
    if encoding in _PLANAR:
        pixels = _planes(message, encoding)
    else:
        pixels = _pixels(message, np.dtype(dtype), channels)
    rgb = pixels if code is None else _converted(pixels, code)
    if encoding == "nv24":
        rgb = rgb[::2, ::2]  # enlarged by `_planes`
    if dtype is np.uint16:
        rgb = cv2.convertScaleAbs(rgb, alpha=255.0 / 65_535.0)
    return np.ascontiguousarray(rgb)


def readable_encodings() -> str:
    """The encodings that are read, for people."""
    return f"{', '.join(_COLOURS)}, JPEG or PNG for colour, {', '.join(_DEPTHS)} for depth"


def depth_of(message: Any) -> Float32[np.ndarray, "height width"]:
    """The depth image of a message, metres along the optical axis; 0 where there is no return.

    Raises:
        RosMessageError: The message holds no depth image, or a broken one.
    """
    encoding = encoding_of(message)
    if kind_of(message) is not ImageKind.DEPTH:
        raise RosMessageError(
            f"expected a depth image (16UC1 in millimetres or 32FC1 in metres), found "
            f"'{encoding:.40}'"
        )
    if _is_compressed(message):
        values = _decompressed_depth(message, encoding)
    else:
        values = _pixels(message, np.dtype(_DEPTHS[encoding]), 1)[:, :, 0].astype(np.float32)
    # REP 118: NaN and infinities are pixels without a return.
    values = np.where(np.isfinite(values), values, np.float32(0.0))
    return values / np.float32(depth_per_metre(encoding))


def depth_per_metre(encoding: str) -> float:
    """The value of one metre in depth of an encoding, by REP 118."""
    return 1.0 if encoding == "32FC1" else 1000.0


def encoding_of(message: Any) -> str:
    """The encoding of an image; of a compressed one that of the image that was compressed."""
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


def _planes(message: Any, encoding: str) -> UInt8[np.ndarray, "rows width 1"]:
    """Brightness, and below it the chroma of every 2 × 2 pixels.

    OpenCV converts no chroma of single pixels (nv24), so that of every pixel becomes that of 2 × 2.
    """
    height, width = message.height, message.width
    per_pixel = 2.0 if encoding == "nv24" else 0.5
    data = np.frombuffer(message.data, dtype=np.uint8)
    size = int(height * width * (1.0 + per_pixel))
    # Drivers disagree about the step of such images; without padding it says nothing.
    step = width if data.size == size else message.step
    if height % 2 or width % 2 or not (0 < height * width <= MOST_PIXELS and step >= width):
        raise RosMessageError(
            f"expected an image of {encoding} with even sides and at most {MOST_PIXELS:,} pixels, "
            f"found {width} × {height} pixels and rows of {step} bytes"
        )
    size = int(height * step * (1.0 + per_pixel))
    if data.size < size:
        raise RosMessageError(f"an image of {size} bytes ends after {data.size}")
    brightness = data[: height * step].reshape(height, step)[:, :width]
    chroma = data[height * step : size]
    if encoding != "nv24":
        rows = chroma.reshape(height // 2, step)[:, :width]
        return np.vstack([brightness, rows])[:, :, None]
    rows = chroma.reshape(height, 2 * step)[:, : 2 * width]
    return np.vstack([brightness.repeat(2, axis=0).repeat(2, axis=1), rows])[:, :, None]


def _converted(pixels: np.ndarray, code: int) -> np.ndarray:
    try:
        return cv2.cvtColor(np.ascontiguousarray(pixels), code)
    except cv2.error as error:
        height, width = pixels.shape[:2]
        raise RosMessageError(
            f"an image of {width} × {height} pixels can't have its encoding: {error.err}"
        ) from error


def _decompressed_colour(message: Any, encoding: str) -> UInt8[np.ndarray, "height width 3"]:
    rgb = _decoded(bytes(message.data), "RGB")
    if not encoding.startswith("bayer") or (rgb != rgb[:, :, :1]).any():
        return rgb
    # Transports that don't say into what they convert compress the pattern as it is.
    _, _, code = _COLOURS[encoding]
    return _converted(rgb[:, :, :1], code or 0)


def _decompressed_depth(message: Any, encoding: str) -> Float32[np.ndarray, "height width"]:
    data = bytes(message.data)
    if _COMPRESSED_DEPTH not in message.format:
        return _decoded(data, "I;16").astype(np.float32)
    if message.format.rstrip().endswith("rvl"):
        raise RosMessageError(
            "cannot read depth compressed by RVL; use the raw topic or compressedDepth with PNG"
        )
    if len(data) < _DEPTH_HEADER.size:
        raise RosMessageError(f"a compressed depth image ends after {len(data)} bytes")
    _, near, far = _DEPTH_HEADER.unpack_from(data)
    values = _decoded(data[_DEPTH_HEADER.size :], "I;16").astype(np.float32)
    if encoding != "32FC1":
        return values
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = np.float32(near) / (values - np.float32(far))
    return np.where(values > 0.0, depth, np.float32(0.0))


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
