"""Arrays in a NumPy archive (``.npz``) from outside: counted before they are allocated."""

import io
import math
import re
import struct
import zipfile
import zlib
from collections.abc import Callable, Mapping

import numpy as np

_CHUNK_BYTES = 1 << 18
_ENTRY = b"PK\x01\x02"
_METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
_IS_ENCRYPTED = 0x1
_PREAMBLE = struct.Struct("<8sH")
_MAGIC = b"\x93NUMPY\x01\x00"
_HEADER = re.compile(
    rb"\{'descr': '(\|[biu]1|<[iuf][248])', 'fortran_order': False, "
    rb"'shape': \(((?:\d{1,12}(?:, ?|(?=\))))*)\), \} *\n"
)
"""The only header that is read: Python's literals, as `numpy.load` takes them, can be anything."""
_BROKEN = (zipfile.BadZipFile, zlib.error, EOFError, RuntimeError, struct.error, OverflowError)
"""What zipfile raises, besides `ValueError`, for an archive that is none."""


def arrays_in(
    content: bytes, most_bytes: Mapping[str, int], spend: Callable[[int, str], object]
) -> dict[str, np.ndarray]:
    """The arrays that `numpy.savez` or `numpy.savez_compressed` wrote, by name.

    Args:
        content: The archive.
        most_bytes: For every name that an array may have, the largest size of it.
        spend: Function that is told the size of an array, bytes, and what it is, before it is
            allocated. Its errors are passed on.

    Raises:
        ValueError: It is no such archive, or a damaged one, or holds something else.
    """
    if content.count(_ENTRY) > len(most_bytes):
        raise ValueError(f"it has more than {len(most_bytes)} members")
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            entries = {one.filename.removesuffix(".npy"): one for one in archive.infolist()}
            if not entries.keys() <= most_bytes.keys():
                raise ValueError("it has members of other names")
            return {
                name: _array(archive, one, most_bytes[name], spend) for name, one in entries.items()
            }
    except _BROKEN as error:
        raise ValueError(f"it is no whole archive: {error}") from error


def _array(
    archive: zipfile.ZipFile,
    entry: zipfile.ZipInfo,
    most_bytes: int,
    spend: Callable[[int, str], object],
) -> np.ndarray:
    name = entry.filename
    if entry.compress_type not in _METHODS or entry.flag_bits & _IS_ENCRYPTED:
        raise ValueError(f"{name} is packed in a way that NumPy doesn't use")
    with archive.open(entry) as member:
        magic, length = _PREAMBLE.unpack(member.read(_PREAMBLE.size))
        header = _HEADER.fullmatch(member.read(length))
        if magic != _MAGIC or header is None:
            raise ValueError(f"{name} is no array of plain numbers")
        kind, sides = np.dtype(header[1].decode()), header[2].decode().split(",")
        shape = tuple(int(side) for side in sides if side.strip())
        size = math.prod(shape) * kind.itemsize
        if size > most_bytes:
            raise ValueError(f"{name} has {size:,} bytes, at most {most_bytes:,} are read")
        spend(size, f"the array {name}")
        array = np.empty(shape, kind)
        left = array.reshape(-1).view(np.uint8).data
        while len(left) and (part := member.read(min(len(left), _CHUNK_BYTES))):
            left[: len(part)] = part
            left = left[len(part) :]
        if len(left) or member.read(1):  # reaching the end compares the checksum
            raise ValueError(f"{name} has another size than its header says")
    return array
