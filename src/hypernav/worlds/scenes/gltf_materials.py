"""Materials and images of a glTF file."""

import hashlib
import logging
from typing import Any, TypeVar

import numpy as np
from pydantic import BaseModel, ValidationError

from hypernav.core.errors import SceneError
from hypernav.io.reading import MOST_PIXELS, image_size
from hypernav.worlds.drawing.textures import linear_to_srgb
from hypernav.worlds.scenes.basis_images import basis_size, is_basis
from hypernav.worlds.scenes.gltf_file import GltfFile
from hypernav.worlds.scenes.gltf_format import (
    GltfMaterial,
    SpecularGlossiness,
    TextureInfo,
    TextureTransform,
)
from hypernav.worlds.scenes.images import DecodedImage, decode_images
from hypernav.worlds.scenes.scene import Material, Wrap

_WRAPS = {10497: Wrap.REPEAT, 33648: Wrap.MIRROR, 33071: Wrap.CLAMP}
_IMAGE_EXTENSIONS = ("EXT_texture_webp", "KHR_texture_basisu", "GOOGLE_texture_basis")
"""Extensions that name the image of a texture in place of its source."""
_MIN_EMISSION = 0.5
_LOGGER = logging.getLogger(__name__)
_Part = TypeVar("_Part", bound=BaseModel)


def read_materials(file: GltfFile) -> tuple[list[Material], list[TextureTransform]]:
    """All materials of a file, with the transforms of their textures.

    A plain light grey one, for primitives without a material, comes last. A material whose image is
    missing or cannot be decoded has only its colour, with a warning.

    Raises:
        SceneError: An image is too large, or of a kind that cannot be read.
    """
    infos = [_base_color(file, source)[1] for source in file.document.materials]
    sources = {_source(file, info) for info in infos if info is not None}
    images = _decode(file, sorted(sources))
    opaque: dict[tuple[int, float], np.ndarray] = {}
    materials = [_material(file, source, images, opaque) for source in file.document.materials]
    materials.append(Material("default", (0.8, 0.8, 0.8)))
    transforms = [_transform(file, info) for info in infos]
    return materials, [*transforms, TextureTransform()]


def _material(
    file: GltfFile,
    source: GltfMaterial,
    images: dict[int, DecodedImage],
    opaque: dict[tuple[int, float], np.ndarray],
) -> Material:
    color, info = _base_color(file, source)
    light = np.array(color[:3])
    unlit = "KHR_materials_unlit" in source.extensions
    if max(source.emissive_factor) >= _MIN_EMISSION and source.emissive_texture is None:
        light, unlit = np.maximum(light, source.emissive_factor), True
    codes = linear_to_srgb(light)
    srgb = (float(codes[0]), float(codes[1]), float(codes[2]))
    number = None if info is None else _source(file, info)
    image = None if number is None else images.get(number)
    if info is None or number is None or image is None:
        return Material(source.name, srgb, unlit=unlit)
    holes = None
    if image.opacity is not None and source.alpha_mode != "OPAQUE":
        cutoff = source.alpha_cutoff if source.alpha_mode == "MASK" else 0.5
        # One array per image, so that materials that share it share its texels, too.
        holes = opaque.setdefault((number, cutoff), image.opacity >= cutoff * 255.0)
    texture = file.document.textures[info.index]
    wrap = (Wrap.REPEAT, Wrap.REPEAT)
    if texture.sampler is not None:
        sampler = file.item(file.document.samplers, texture.sampler, "sampler")
        wrap = (_WRAPS[sampler.wrap_s], _WRAPS[sampler.wrap_t])
    return Material(source.name, srgb, image.rgb, wrap, holes, unlit)


def _base_color(
    file: GltfFile, source: GltfMaterial
) -> tuple[tuple[float, float, float, float], TextureInfo | None]:
    """Colour factor and texture, from either of their two forms."""
    old = source.extensions.get("KHR_materials_pbrSpecularGlossiness")
    if old is not None and source.pbr_metallic_roughness.base_color_texture is None:
        diffuse = _extension(file, SpecularGlossiness, old)
        return diffuse.diffuse_factor, diffuse.diffuse_texture
    surface = source.pbr_metallic_roughness
    return surface.base_color_factor, surface.base_color_texture


def _transform(file: GltfFile, info: TextureInfo | None) -> TextureTransform:
    if info is None:
        return TextureTransform()
    raw = info.extensions.get("KHR_texture_transform", {})
    transform = _extension(file, TextureTransform, raw)
    if transform.tex_coord is None:
        return transform.model_copy(update={"tex_coord": info.tex_coord})
    return transform


def _extension(file: GltfFile, kind: type[_Part], raw: Any) -> _Part:
    try:
        return kind.model_validate(raw)
    except ValidationError as error:
        first = error.errors()[0]
        raise file.invalid(f"an extension holds a wrong value: {first['msg']}") from error


def _source(file: GltfFile, info: TextureInfo) -> int:
    """The number of the image of a texture."""
    texture = file.item(file.document.textures, info.index, "texture")
    for name in _IMAGE_EXTENSIONS:
        other = texture.extensions.get(name)
        if isinstance(other, dict) and isinstance(other.get("source"), int):
            return other["source"]
    if texture.source is None:
        names = ", ".join(texture.extensions) or "nothing"
        raise SceneError(
            f"{file.path}: a texture is stored as {names}, which cannot be read; "
            "export the file again with PNG or JPEG textures"
        )
    return texture.source


def _decode(file: GltfFile, numbers: list[int]) -> dict[int, DecodedImage]:
    """Decode images on all cores; equal bytes give one and the same image.

    Those that are missing or broken are left out.
    """
    data: dict[int, bytes] = {}
    broken: list[str] = []
    for number in numbers:
        image = file.item(file.document.images, number, "image")
        try:
            content = file.image_bytes(image)
        except SceneError as error:
            broken.append(str(error))
            continue
        if _is_image(file, number, content):
            data[number] = content
        else:
            broken.append(_undecodable(file, number))
    keys = {number: hashlib.sha256(content).digest() for number, content in data.items()}
    distinct = {keys[number]: content for number, content in data.items()}
    decoded = decode_images(distinct)
    found = {number: decoded[key] for number, key in keys.items()}
    broken += [_undecodable(file, number) for number, image in found.items() if image is None]
    if broken:
        more = f" and so for {len(broken) - 1} more textures" if len(broken) > 1 else ""
        _LOGGER.warning("%s; until then its surfaces have a plain colour%s", broken[0], more)
    return {number: image for number, image in found.items() if image is not None}


def _undecodable(file: GltfFile, number: int) -> str:
    return (
        f"{file.path}: texture {number} cannot be decoded; export the file again with PNG or JPEG "
        "textures"
    )


def _is_image(file: GltfFile, number: int, content: bytes) -> bool:
    """Whether the header is that of an image; too large images are refused before decoding."""
    size = basis_size(content) if is_basis(content) else image_size(content)
    if size is None:
        return False
    width, height = size
    what = f"texture {number} with {width} × {height} pixels"
    if width * height > MOST_PIXELS:
        raise SceneError(
            f"{file.path}: {what} is too large, at most {MOST_PIXELS:,} pixels are read; make it "
            "smaller"
        )
    file.allowance.take(3 * width * height, what)
    return True
