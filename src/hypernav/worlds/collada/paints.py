"""Colours and textures of the materials in a COLLADA document."""

import xml.etree.ElementTree as ElementTree
from collections.abc import Callable, Iterator
from pathlib import Path
from urllib.parse import unquote

from hypernav.worlds.collada.triangles import numbers_of
from hypernav.worlds.scenes.paints import Paint

PLAIN = Paint("default", (0.8, 0.8, 0.8))
"""For triangles without a material."""
FindImage = Callable[[str], Path | None]


def read_paints(root: ElementTree.Element, find_image: FindImage) -> dict[str, Paint]:
    """The materials of a document by their identifiers.

    Args:
        root: The document.
        find_image: The file of an image that the document names, or None.

    Raises:
        ValueError: A colour is no number.
    """
    images = {
        image.get("id", ""): (image.findtext("init_from/ref") or image.findtext("init_from") or "")
        for image in root.iter("image")
    }
    effects = {effect.get("id", ""): effect for effect in root.iter("effect")}
    paints: dict[str, Paint] = {}
    for material in root.iter("material"):
        name = material.get("name") or material.get("id", "")
        instance = material.find("instance_effect")
        effect = None if instance is None else effects.get(instance.get("url", "")[1:])
        paints[material.get("id", "")] = (
            PLAIN if effect is None else _paint(name, effect, images, find_image)
        )
    return paints


def _paint(
    name: str, effect: ElementTree.Element, images: dict[str, str], find_image: FindImage
) -> Paint:
    color, reference = (PLAIN.color, "")
    for channel in _channels(effect, "diffuse"):
        texture = channel.find("texture")
        if texture is not None:
            reference = _image_of(effect, texture.get("texture", ""), images)
        elif (text := channel.findtext("color")) is not None:
            color = _color(text)
    has_holes = any(
        channel.find("texture") is not None for channel in _channels(effect, "transparent")
    )
    image = find_image(reference) if reference else None
    return Paint(name, color, reference, image, has_holes)


def _channels(effect: ElementTree.Element, name: str) -> Iterator[ElementTree.Element]:
    for model in ("phong", "lambert", "blinn", "constant"):
        yield from effect.iterfind(f"profile_COMMON/technique/{model}/{name}")


def _image_of(effect: ElementTree.Element, sampler: str, images: dict[str, str]) -> str:
    """The file of a texture, through its sampler and surface; some exporters name it at once."""
    parameters = {item.get("sid", ""): item for item in effect.iter("newparam")}
    name = sampler
    for step in ("sampler2D/source", "surface/init_from"):
        if name in parameters:
            name = (parameters[name].findtext(step) or "").strip() or name
    if sampler in parameters:
        instance = parameters[sampler].find("sampler2D/instance_image")
        name = name if instance is None else instance.get("url", "")[1:]
    return unquote(images.get(name, "").strip()).removeprefix("file://").replace("\\", "/")


def _color(text: str) -> tuple[float, float, float]:
    red, green, blue = (
        min(max(float(value), 0.0), 1.0) for value in [*numbers_of(text), 0, 0, 0][:3]
    )
    return red, green, blue
