"""Materials whose images are files: named first, decoded together at the end."""

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hypernav.io.reading import MOST_PIXELS, Allowance, image_size, read_file
from hypernav.worlds.scenes.images import DecodedImage, decode_images
from hypernav.worlds.scenes.scene import Material

_OPAQUE = 128
_LOGGER = logging.getLogger(__name__)


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
            allowance.take(3 * size[0] * size[1], f"the texture {path.name:.80}")
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
