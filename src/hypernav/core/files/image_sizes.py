"""Sizes of encoded images, from their headers alone: nothing is decoded."""

import struct

MOST_PIXELS = 8192 * 4096
"""The largest image that is decoded."""

_PNG, _JPEG, _RIFF, _WEBP = b"\x89PNG\r\n\x1a\n", b"\xff\xd8", b"RIFF", b"WEBP"
_MOST_CHUNKS = 1_000_000
_START_OF_SCAN = b"\xff\xda"
_MOST_SCANS = 100
"""Largest number of scans of a JPEG: each costs a pass over the image, but few bytes of file."""
_FRAME_HEADERS = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
_WITHOUT_LENGTH = frozenset({0x01, *range(0xD0, 0xD9)})


def image_size(data: bytes) -> tuple[int, int] | None:
    """Width and height of a PNG, JPEG or WebP image, pixels.

    Args:
        data: The encoded image.

    Returns:
        None if it has another format, or its header is broken.
    """
    try:
        if data.startswith(_PNG):
            return struct.unpack_from(">II", data, 16) if _holds_its_chunks(data) else None
        if data.startswith(_JPEG):
            return None if data.count(_START_OF_SCAN) > _MOST_SCANS else _jpeg_size(data)
        if data.startswith(_RIFF) and data[8:12] == _WEBP:
            return _webp_size(data)
    except (struct.error, IndexError):
        pass
    return None


def _holds_its_chunks(data: bytes) -> bool:
    """Whether no chunk of a PNG says that it is longer than the file: decoders allocate first."""
    at = len(_PNG)
    for _ in range(_MOST_CHUNKS):
        if at + 8 > len(data):
            return at <= len(data)
        at += 12 + int.from_bytes(data[at : at + 4], "big")
    return False


def _jpeg_size(data: bytes) -> tuple[int, int] | None:
    at = data.find(b"\xff", 2)
    while at >= 0:
        marker = data[at + 1]
        if marker == 0xFF:
            at += 1
        elif marker in _FRAME_HEADERS:
            height, width = struct.unpack_from(">HH", data, at + 5)
            return width, height
        else:
            length = 0 if marker in _WITHOUT_LENGTH else struct.unpack_from(">H", data, at + 2)[0]
            at = data.find(b"\xff", at + 2 + length)
    return None


def _webp_size(data: bytes) -> tuple[int, int] | None:
    kind = data[12:16]
    if kind == b"VP8X":
        width, height = (int.from_bytes(data[at : at + 3], "little") + 1 for at in (24, 27))
        return width, height
    if kind == b"VP8L":
        bits = struct.unpack_from("<I", data, 21)[0]
        return (bits & 0x3FFF) + 1, (bits >> 14 & 0x3FFF) + 1
    if kind == b"VP8 ":
        width, height = struct.unpack_from("<HH", data, 26)
        return width & 0x3FFF, height & 0x3FFF
    return None
