"""Images in Basis Universal: KTX 2 files (``KHR_texture_basisu``) and ``.basis`` files.

HM3D's ``*.basis.glb`` hold ``.basis`` images by the extension ``GOOGLE_texture_basis``. Magnum,
with which habitat-sim reads them, assumes that a ``.basis`` image begins with its bottom row,
whatever its flags say (BasisImporter, "Behavior and limitations"); a KTX 2 image begins with the
top row, as ``KHR_texture_basisu`` requires.
"""

import math
import struct
from typing import Any

import numpy as np
from jaxtyping import UInt8

from hypernav.core.components.registry import require

_KTX2, _BASIS = b"\xabKTX 20\xbb\r\n\x1a\n", b"sB"
_ZSTANDARD = 2
_BLOCK_BYTES = 16


def is_basis(content: bytes) -> bool:
    """Whether an encoded image is a KTX 2 or ``.basis`` file."""
    return content.startswith((_KTX2, _BASIS))


def basis_size(content: bytes) -> tuple[int, int] | None:
    """Width and height of an image, pixels; None if its header is broken.

    Raises:
        MissingExtraError: The package that reads it is not installed.
    """
    texture = _opened(content)
    return None if texture is None else (int(texture.width), int(texture.height))


def decode_basis(content: bytes) -> UInt8[np.ndarray, "height width 4"] | None:
    """The largest level of an image as RGBA, top row first; None if it is broken.

    Raises:
        MissingExtraError: The package that reads it is not installed.
    """
    basisu = require("opengl_basisu", extra="hm3d")
    texture = _opened(content)
    if texture is None:
        return None
    try:
        rgba = texture.transcode(basisu.Target.RGBA8).data
    except (ValueError, IndexError, MemoryError):
        return None
    return np.ascontiguousarray(rgba[::-1] if content.startswith(_BASIS) else rgba)


def _opened(content: bytes) -> Any:
    """The image with its header read; None if the header is broken or gives wrong sizes."""
    basisu = require("opengl_basisu", extra="hm3d")
    try:
        texture = basisu.open(content)
    except (ValueError, MemoryError):
        return None
    return texture if _unpacks_to_its_size(content, texture) else None


def _unpacks_to_its_size(content: bytes, texture: Any) -> bool:
    """Whether a compressed level has no more bytes than its pixels need."""
    if not content.startswith(_KTX2):
        return True
    try:
        (scheme,) = struct.unpack_from("<I", content, 44)
        (unpacked,) = struct.unpack_from("<Q", content, 80 + 16)
    except struct.error:
        return False
    blocks = math.ceil(texture.width / 4) * math.ceil(texture.height / 4)
    count = max(texture.layers, 1) * max(texture.faces, 1)
    return scheme != _ZSTANDARD or unpacked <= blocks * count * _BLOCK_BYTES
