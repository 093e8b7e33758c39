"""Images of materials: their decoding, and materials that name a file, decoded together at the end.

HM3D's ``*.basis.glb`` hold ``.basis`` images by the extension ``GOOGLE_texture_basis``. Magnum,
with which habitat-sim reads them, assumes that a ``.basis`` image begins with its bottom row,
whatever its flags say (BasisImporter, "Behavior and limitations"); a KTX 2 image begins with the
top row, as ``KHR_texture_basisu`` requires.
"""

import logging
import math
import os
import struct
import sys
import threading
from collections.abc import Hashable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import cv2
import numpy as np
from jaxtyping import UInt8

from hypernav.core.components.registry import require
from hypernav.io.reading import MOST_PIXELS, Allowance, image_size, read_file
from hypernav.simulator.worlds.scenes.scene import Material

_KTX2, _BASIS = b"\xabKTX 20\xbb\r\n\x1a\n", b"sB"
_ZSTANDARD = 2
_BLOCK_BYTES = 16
KeyT = TypeVar("KeyT", bound=Hashable)
_REDIRECTION = threading.Lock()
_OPAQUE = 128
_LOGGER = logging.getLogger(__name__)


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


@dataclass(frozen=True, eq=False)
class DecodedImage:
    """A decoded image.

    Attributes:
        rgb: Colours, sRGB.
        opacity: Opacity, 0 to 255; None where all of it is opaque.
    """

    rgb: UInt8[np.ndarray, "height width 3"]
    opacity: UInt8[np.ndarray, "height width"] | None


def decode_images(contents: Mapping[KeyT, bytes]) -> dict[KeyT, DecodedImage | None]:
    """Decode images whose sizes were checked; None for those that are broken.

    What the decoders themselves write to standard error about broken ones is dropped.
    """
    with _silent_libraries(), ThreadPoolExecutor() as pool:
        return dict(zip(contents, pool.map(decode_image, contents.values()), strict=True))


@contextmanager
def _silent_libraries() -> Iterator[None]:
    """Send what compiled libraries write to standard error in the block to nowhere."""
    with _REDIRECTION:  # two at once would restore each other's
        if sys.stderr is not None:
            sys.stderr.flush()
        try:
            kept = os.dup(2)
        except OSError:  # it is closed
            yield
            return
        try:
            with open(os.devnull, "wb") as nowhere:
                os.dup2(nowhere.fileno(), 2)
            yield
        finally:
            os.dup2(kept, 2)
            os.close(kept)


def decode_image(content: bytes) -> DecodedImage | None:
    """Decode an image whose size was checked; None if it is broken."""
    if not content:
        return None
    if is_basis(content):
        rgba = decode_basis(content)
        return None if rgba is None else _with_opacity(rgba[..., :3], rgba[..., 3])
    image = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_UNCHANGED)
    if image is None or image.dtype not in (np.uint8, np.uint16):
        return None
    if image.dtype == np.uint16:
        image = (image // np.uint16(257)).astype(np.uint8)
    if image.ndim == 2:
        return DecodedImage(cv2.cvtColor(image, cv2.COLOR_GRAY2RGB), None)
    if image.shape[2] == 3:
        return DecodedImage(cv2.cvtColor(image, cv2.COLOR_BGR2RGB), None)
    return _with_opacity(cv2.cvtColor(image, cv2.COLOR_BGRA2RGB), image[..., 3])


def _with_opacity(
    rgb: UInt8[np.ndarray, "height width 3"], opacity: UInt8[np.ndarray, "height width"]
) -> DecodedImage:
    is_opaque = bool(opacity.min() == 255)
    return DecodedImage(
        np.ascontiguousarray(rgb), None if is_opaque else np.ascontiguousarray(opacity)
    )


@dataclass(frozen=True)
class Paint:
    """A material before its image is decoded.

    Attributes:
        name: Name, for people.
        color: Colour, sRGB, 0 to 1; the one to take if the image cannot be read.
        reference: What the file calls its image; empty without one.
        image: The file of the image; None if there is none, or it was not found.
        has_holes: Whether transparent texels of the image are holes.
    """

    name: str
    color: tuple[float, float, float]
    reference: str = ""
    image: Path | None = None
    has_holes: bool = False


def materials_of(
    owner: Path, paints: Sequence[Paint | Material], allowance: Allowance
) -> list[Material]:
    """The materials, with their images decoded on all cores, each once; finished ones stay.

    Those whose image is missing or broken have their colour alone, and one warning says so.

    Args:
        owner: File that the paints come from, for messages.
        paints: The materials.
        allowance: Memory that the images may take.

    Raises:
        OSError: The images would take too much memory.
    """
    contents: dict[Path, bytes] = {}
    named = [paint.image for paint in paints if isinstance(paint, Paint)]
    for path in dict.fromkeys(path for path in named if path is not None):
        content = _content(path)
        size = image_size(content)
        if size is not None and size[0] * size[1] <= MOST_PIXELS:
            allowance.spend(3 * size[0] * size[1], f"the texture {path.name:.80}")
            contents[path] = content
    images = decode_images(contents)
    holes = {
        path: image.opacity >= _OPAQUE
        for path, image in images.items()
        if image is not None and image.opacity is not None
    }
    unread: dict[str, None] = {}
    materials = []
    for paint in paints:
        if isinstance(paint, Material):
            materials.append(paint)
            continue
        image = None if paint.image is None else images.get(paint.image)
        if paint.reference and image is None:
            unread[paint.reference] = None
        materials.append(_material(paint, image, holes))
    if unread:
        first, more = next(iter(unread)), len(unread) - 1
        _LOGGER.warning(
            "%s: the texture %.80s cannot be read; until it is found as PNG or JPEG its surfaces "
            "have a plain colour%s",
            owner,
            first,
            f" and so for {more} more textures" if more else "",
        )
    return materials


def _material(paint: Paint, image: DecodedImage | None, holes: dict[Path, np.ndarray]) -> Material:
    if image is None or paint.image is None:
        return Material(paint.name, paint.color)
    opaque = holes.get(paint.image) if paint.has_holes else None
    return Material(paint.name, (1.0, 1.0, 1.0), image.rgb, opaque=opaque)


def _content(path: Path) -> bytes:
    try:
        return read_file(path)
    except OSError:
        return b""
