import io
import struct
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from hypernav.io.reading import image_size

SIDES = st.integers(1, 300)


def encoded(width: int, height: int, **how: Any) -> bytes:
    file = io.BytesIO()
    Image.new("RGB", (width, height), (1, 2, 3)).save(file, **how)
    return file.getvalue()


@given(
    SIDES,
    SIDES,
    st.sampled_from(
        [
            {"format": "PNG"},
            {"format": "JPEG"},
            {"format": "JPEG", "progressive": True, "comment": b"\xff\xc0\xff"},
            {"format": "WEBP"},
            {"format": "WEBP", "lossless": True},
            {"format": "WEBP", "exif": b"Exif\0\0"},
        ]
    ),
)
def test_the_header_tells_the_size(width, height, how):
    assert image_size(encoded(width, height, **how)) == (width, height)


@given(st.binary(max_size=60), st.sampled_from([b"", b"\x89PNG\r\n\x1a\n", b"\xff\xd8", b"RIFF"]))
def test_nothing_else_has_one_or_breaks_it(rest, start):
    size = image_size(start + rest)
    assert size is None or len(size) == 2


@pytest.mark.parametrize("end", [0, 3, 10, 20])
@pytest.mark.parametrize("kind", ["PNG", "JPEG", "WEBP"])
def test_a_header_that_is_cut_off_tells_nothing(kind, end):
    assert image_size(encoded(5, 7, format=kind)[:end]) is None


@pytest.mark.parametrize("marker", range(0xC0, 0xD0))
def test_a_jpeg_has_the_size_of_its_frame_whatever_tables_come_before(marker):
    """Of the markers of this range, those of Huffman tables, extensions and coding are none."""

    def segment(name: int, width: int, height: int) -> bytes:
        return bytes([0xFF, name]) + struct.pack(">HBHH", 8, 8, height, width) + b"\0"

    size = image_size(b"\xff\xd8" + segment(marker, 30, 20) + segment(0xC0, 7, 5) + b"\xff\xd9")
    assert size == ((7, 5) if marker in (0xC4, 0xC8, 0xCC) else (30, 20))


def test_a_jpeg_of_endless_scans_is_none():
    whole = encoded(8, 8, format="JPEG")
    scan = b"\xff\xda" + struct.pack(">H", 8) + b"\x01\x01\x00\x00\x3f\x00"
    assert image_size(whole[:-2] + scan * 50 + whole[-2:]) == (8, 8)
    assert image_size(whole[:-2] + scan * 5000 + whole[-2:]) is None
