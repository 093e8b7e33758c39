"""Decoding of a texture's image."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import UInt8

from hypernav.worlds.scenes.basis_images import decode_basis, is_basis


@dataclass(frozen=True, eq=False)
class DecodedImage:
    """A decoded image.

    Attributes:
        rgb: Colours, sRGB.
        opacity: Opacity, 0 to 255; None where all of it is opaque.
    """

    rgb: UInt8[np.ndarray, "height width 3"]
    opacity: UInt8[np.ndarray, "height width"] | None


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
