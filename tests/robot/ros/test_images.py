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


@pytest.mark.parametrize("encoding", ["mono8", "8UC1", "yuv422", "bayer_rggb8"])
def test_grey_images_are_neither_colour_nor_depth(encoding):
    assert kind_of(raw(encoding, np.zeros((2, 2), dtype=np.uint8))) is None


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
