"""Images of every encoding mean the same, and broken ones are refused by name."""

import io
import struct
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from hypernav.core.errors import RosMessageError
from hypernav.robot.ros.images import ImageKind, colour_of, depth_of, kind_of


def raw(encoding: str, pixels: np.ndarray, *, padding: int = 0, big: bool = False):
    rows = pixels.reshape(len(pixels), -1).view(np.uint8)
    padded = np.pad(rows, ((0, 0), (0, padding)), constant_values=9)
    return SimpleNamespace(
        height=pixels.shape[0],
        width=pixels.shape[1],
        encoding=encoding,
        is_bigendian=int(big),
        step=padded.shape[1],
        data=padded.tobytes(),
    )


def png(pixels: np.ndarray) -> bytes:
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, "PNG")
    return file.getvalue()


def compressed(format: str, data: bytes):
    return SimpleNamespace(format=format, data=data)


@given(st.integers(0, 7), st.booleans())
def test_depth_in_millimetres_and_metres_is_the_same_whatever_the_rows_and_byte_order(padding, big):
    millimetres = np.array([[0, 500], [1250, 65_535]], dtype=">u2" if big else "<u2")
    depth = depth_of(raw("16UC1", millimetres, padding=padding, big=big))
    assert np.allclose(depth, [[0.0, 0.5], [1.25, 65.535]])
    metres = np.array([[np.nan, 0.5], [1.25, np.inf]], dtype=">f4" if big else "<f4")
    depth = depth_of(raw("32FC1", metres, padding=padding, big=big))
    assert depth.tolist() == [[0.0, 0.5], [1.25, 0.0]]


def test_quantised_depth_is_undone():
    near, far = 100.0, 2.0
    values = np.array([[0, 102, 52]], dtype=np.uint16)
    data = struct.pack("<Iff", 0, near, far) + png(values)
    depth = depth_of(compressed("32FC1; compressedDepth png", data))
    assert depth.tolist() == [[0.0, 1.0, 2.0]]


PATCHES = np.array([[200, 40, 30], [30, 60, 210], [60, 180, 70]], dtype=np.uint8)
PICTURE = np.broadcast_to(PATCHES.repeat(8, axis=0), (12, 24, 3))
"""Three patches of one colour each; whatever the encoding halves stays inside of one."""


def yuv(picture: np.ndarray) -> np.ndarray:
    """Brightness and chroma by BT.601, with the range of video."""
    r, g, b = np.moveaxis(picture.astype(float), 2, 0) / 255.0
    y = 16.0 + 65.481 * r + 128.553 * g + 24.966 * b
    u = 128.0 - 37.797 * r - 74.203 * g + 112.0 * b
    v = 128.0 + 112.0 * r - 93.786 * g - 18.214 * b
    return np.rint(np.dstack([y, u, v])).astype(np.uint8)


def packed(order: str) -> np.ndarray:
    """Chroma of every second pixel, in turn with brightness."""
    y, u, v = np.moveaxis(yuv(PICTURE), 2, 0)
    chroma = np.where(np.arange(24) % 2 == 0, u, v)
    return np.dstack([y, chroma] if order == "yuyv" else [chroma, y])


def planar(step: int, order: str) -> np.ndarray:
    """Brightness, and below it the chroma of every pixel (1), or of every second (2)."""
    y, u, v = np.moveaxis(yuv(PICTURE), 2, 0)
    chroma = np.dstack([u, v] if order == "uv" else [v, u])[::step, ::step]
    return np.vstack([y, chroma.reshape(-1, 24)])


def mosaic(order: str) -> np.ndarray:
    """One colour for each pixel; `order` names those of the first two rows."""
    picture = np.zeros((12, 24), dtype=np.uint8)
    for k, colour in enumerate(order):
        at = np.s_[k // 2 :: 2, k % 2 :: 2]
        picture[at] = PICTURE[(*at, "rgb".index(colour))]
    return picture


def wide(pixels: np.ndarray) -> np.ndarray:
    return pixels.astype(np.uint16) * 257


ALPHA = np.full((12, 24, 1), 7, dtype=np.uint8)
BGR = PICTURE[:, :, ::-1]
ENCODED = {
    "rgb8": PICTURE,
    "bgr8": BGR,
    "8UC3": BGR,
    "rgba8": np.dstack([PICTURE, ALPHA]),
    "bgra8": np.dstack([BGR, ALPHA]),
    "8UC4": np.dstack([BGR, ALPHA]),
    "rgb16": wide(PICTURE),
    "bgr16": wide(BGR),
    "rgba16": wide(np.dstack([PICTURE, ALPHA])),
    "bgra16": wide(np.dstack([BGR, ALPHA])),
    "yuv422": packed("uyvy"),
    "uyvy": packed("uyvy"),
    "yuv422_yuy2": packed("yuyv"),
    "yuyv": packed("yuyv"),
    "nv12": planar(2, "uv"),
    "nv21": planar(2, "vu"),
    "nv24": planar(1, "uv"),
    **{f"bayer_{order}8": mosaic(order) for order in ("rggb", "bggr", "gbrg", "grbg")},
    **{f"bayer_{order}16": wide(mosaic(order)) for order in ("rggb", "bggr", "gbrg", "grbg")},
}


@pytest.mark.parametrize("padding", [0, 6])
@pytest.mark.parametrize("encoding", ENCODED)
def test_every_encoding_is_the_same_picture(encoding, padding):
    pixels = np.ascontiguousarray(ENCODED[encoding])
    chroma_rows = {"nv24": 2 * padding}.get(encoding, padding)
    message = raw(encoding, pixels[:12], padding=padding)
    if len(pixels) > 12:
        rows = pixels[12:].reshape(-1, 48) if encoding == "nv24" else pixels[12:]
        message.data += np.pad(rows, ((0, 0), (0, chroma_rows))).tobytes()
    assert kind_of(message) is ImageKind.COLOUR
    seen = colour_of(message)
    assert (seen.shape, seen.dtype) == ((12, 24, 3), np.uint8)
    for k, colour in enumerate(PATCHES):
        inside = seen[2:10, 8 * k + 2 : 8 * k + 6].astype(int)
        assert np.abs(inside - colour).max() <= 3


@pytest.mark.parametrize("encoding", ["mono8", "8UC1"])
def test_grey_is_grey(encoding):
    seen = colour_of(raw(encoding, np.array([[3, 250]], dtype=np.uint8)))
    assert seen.tolist() == [[[3, 3, 3], [250, 250, 250]]]


def test_a_pattern_that_was_compressed_as_it_is_gets_its_colours():
    message = compressed("bayer_rggb8; png compressed", png(mosaic("rggb")))
    assert np.abs(colour_of(message)[2:10, 2:6].astype(int) - PATCHES[0]).max() <= 3
    message = compressed("bayer_rggb8; png compressed bgr8", png(np.ascontiguousarray(PICTURE)))
    assert np.array_equal(colour_of(message), PICTURE)


@pytest.mark.parametrize("encoding", ["h264", "64FC3", "32SC1"])
def test_what_cannot_be_read_is_neither_colour_nor_depth(encoding):
    message = raw(encoding, np.zeros((2, 2), dtype=np.uint8))
    assert kind_of(message) is None
    with pytest.raises(RosMessageError, match=rf"'{encoding}'.*bayer_rggb8"):
        colour_of(message)


def test_the_kind_of_compressed_images_is_in_their_format():
    assert kind_of(compressed("rgb8; jpeg compressed bgr8", b"")) is ImageKind.COLOUR
    assert kind_of(compressed("jpeg", b"")) is ImageKind.COLOUR
    assert kind_of(compressed("16UC1; compressedDepth png", b"")) is ImageKind.DEPTH


def shortened(message, **changes):
    return SimpleNamespace(**(vars(message) | changes))


COLOUR = raw("rgb8", np.zeros((4, 5, 3), dtype=np.uint8))
DEPTH = raw("16UC1", np.zeros((4, 5), dtype=np.uint16))


@pytest.mark.parametrize(
    ("read", "message", "said"),
    [
        (colour_of, shortened(COLOUR, data=COLOUR.data[:-1]), "ends after 59"),
        (colour_of, shortened(COLOUR, step=14), "rows of 14"),
        (colour_of, shortened(COLOUR, width=10**6, height=10**6), "at most"),
        (colour_of, shortened(COLOUR, width=0), "at most"),
        (colour_of, DEPTH, "colour image"),
        (depth_of, COLOUR, "depth image"),
        (colour_of, raw("yuyv", np.zeros((2, 3, 2), dtype=np.uint8)), "3 × 2"),
        (colour_of, raw("nv12", np.zeros((3, 2), dtype=np.uint8)), "even sides"),
        (colour_of, raw("nv12", np.zeros((4, 4), dtype=np.uint8)), "ends after 16"),
        (colour_of, compressed("jpeg", b"\xff\xd8 nonsense"), "PNG or JPEG"),
        (colour_of, compressed("png", png(np.zeros((9, 9), dtype=np.uint8))[:-30]), "decoded"),
        (depth_of, compressed("16UC1; compressedDepth png", b"short"), "ends after 5"),
        (depth_of, compressed("16UC1; compressedDepth rvl", bytes(40)), "RVL"),
        (
            depth_of,
            compressed("16UC1; png", png(np.zeros((2, 2, 3), dtype=np.uint8))),
            "16 bits",
        ),
    ],
)
def test_a_broken_image_is_refused(read, message, said):
    with pytest.raises(RosMessageError, match=said):
        read(message)
