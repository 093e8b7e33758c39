"""Decoding of a texture's image."""

import os
import sys
import threading
from collections.abc import Hashable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TypeVar

import cv2
import numpy as np
from jaxtyping import UInt8

from hypernav.worlds.scenes.basis_images import decode_basis, is_basis

KeyT = TypeVar("KeyT", bound=Hashable)
_REDIRECTION = threading.Lock()


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
