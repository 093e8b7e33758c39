"""JPEG encoding and content hashes of images sent to a model."""

import base64
import hashlib

import cv2
import numpy as np

from hypernav.core.chat import Image
from hypernav.core.errors import ModelError


def jpeg_bytes(image: Image, *, quality: int = 95) -> bytes:
    """The image as a JPEG file without colour subsampling."""
    done, data = cv2.imencode(
        ".jpg",
        image[..., ::-1],
        [
            cv2.IMWRITE_JPEG_QUALITY,
            quality,
            cv2.IMWRITE_JPEG_SAMPLING_FACTOR,
            cv2.IMWRITE_JPEG_SAMPLING_FACTOR_444,
        ],
    )
    if not done:
        raise ModelError(f"an image of {image.shape} could not be encoded as JPEG")
    return data.tobytes()


def jpeg_base64(image: Image, *, quality: int = 95) -> str:
    """The JPEG file in base64."""
    return base64.b64encode(jpeg_bytes(image, quality=quality)).decode("ascii")


def jpeg_data_url(image: Image, *, quality: int = 95) -> str:
    """The JPEG file as a data URL, the form in which chat APIs take images."""
    return f"data:image/jpeg;base64,{jpeg_base64(image, quality=quality)}"


def content_hash(image: Image) -> str:
    """Hash of an image, equal exactly when size and all pixels are equal."""
    pixels = np.ascontiguousarray(image)
    digest = hashlib.sha256(f"{pixels.shape[1]}x{pixels.shape[0]}:".encode())
    digest.update(pixels.tobytes())
    return digest.hexdigest()
