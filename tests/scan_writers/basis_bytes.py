"""Images in Basis Universal's UASTC, written byte by byte: every 4 × 4 block has one colour."""

import struct

import numpy as np

_SOLID_MODE, _SOLID_BITS = 0x17, 5
_UASTC, _SRGB = 166, 2


def solid_block(color: tuple[int, int, int]) -> bytes:
    """A block of mode 8: the colour, and hints for other formats that nobody reads here."""
    value, at = _SOLID_MODE, _SOLID_BITS
    for channel in (*color, 255):
        value |= int(channel) << at
        at += 8
    return value.to_bytes(16, "little")


def blocks_of(colors: np.ndarray) -> bytes:
    """All blocks of an image with these colours, ``[rows, columns, 3]``, in order of rows."""
    return b"".join(solid_block(tuple(color)) for row in colors for color in row)


def ktx2(colors: np.ndarray) -> bytes:
    """A KTX 2 file (Khronos KTX File Format 2.0) of one level, the top row first."""
    rows, columns = colors.shape[:2]
    data = blocks_of(colors)
    sample = struct.pack("<HBB4BII", 0, 127, 0, 0, 0, 0, 0, 0, 0xFFFFFFFF)
    block = struct.pack("<II", 0, 40 << 16 | 2)
    block += struct.pack("<4B4B8B", _UASTC, 1, _SRGB, 0, 3, 3, 0, 0, 16, 0, 0, 0, 0, 0, 0, 0)
    descriptor = struct.pack("<I", 44) + block + sample
    begin = 80 + 24
    first = (begin + len(descriptor) + 15) // 16 * 16
    header = b"\xabKTX 20\xbb\r\n\x1a\n"
    header += struct.pack("<9I", 0, 1, 4 * columns, 4 * rows, 0, 0, 1, 1, 0)
    header += struct.pack("<4I2Q", begin, len(descriptor), 0, 0, 0, 0)
    header += struct.pack("<3Q", first, len(data), len(data))
    return (header + descriptor).ljust(first, b"\0") + data


def crc16(data: bytes, crc: int = 0) -> int:
    """The check sum of ``.basis`` files (basisu_transcoder, ``crc16``)."""
    crc = ~crc & 0xFFFF
    for byte in data:
        q = byte ^ (crc >> 8)
        k = (q >> 4) ^ q
        crc = ((crc << 8) ^ k ^ (k << 5) ^ (k << 12)) & 0xFFFF
    return ~crc & 0xFFFF


def basis(colors: np.ndarray) -> bytes:
    """A ``.basis`` file of one slice, the bottom row first, as HM3D has them."""
    rows, columns = colors.shape[:2]
    data = blocks_of(colors[::-1])
    first_slice, header_size = 77, 77
    slice_size = 23
    at = header_size + slice_size
    slices = (0).to_bytes(3, "little") + struct.pack(
        "<BBHHHHIIH", 0, 0, 4 * columns, 4 * rows, columns, rows, at, len(data), crc16(data)
    )
    body = slices + data
    flags = 1 << 1  # rows are flipped
    tail = struct.pack("<I", len(body)) + struct.pack("<H", crc16(body))
    tail += (1).to_bytes(3, "little") + (1).to_bytes(3, "little")
    tail += struct.pack("<B", 1) + struct.pack("<H", flags) + struct.pack("<B", 0)
    tail += (0).to_bytes(3, "little") + struct.pack("<III", 0, 0, 0)
    tail += struct.pack("<HI", 0, 0) + (0).to_bytes(3, "little")
    tail += struct.pack("<HI", 0, 0) + (0).to_bytes(3, "little")
    tail += struct.pack("<II", 0, 0) + struct.pack("<III", first_slice, 0, 0)
    head = struct.pack("<HHH", 0x4273, 0x13, header_size)
    return head + struct.pack("<H", crc16(tail)) + tail + body
