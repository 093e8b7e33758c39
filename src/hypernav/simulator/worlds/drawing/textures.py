"""Textures in the renderer's form: one flat array that holds every image in every size.

Each image is followed by its halvings down to one texel (mip maps), so that a surface far away
is read from an image whose texels are as large as the pixels. Halving averages light, not sRGB
numbers: a distant black and white checkerboard has the brightness of the real thing.
"""

import math
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache, partial
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np
from jaxtyping import Bool, Float32, Int32, Int64, UInt8, UInt32

from hypernav.io.kept_arrays import digest_of, kept_arrays
from hypernav.simulator.worlds.drawing import texture_kernels
from hypernav.simulator.worlds.drawing.texture_kernels import encode, halve
from hypernav.simulator.worlds.scenes.scene import Material, Scene

_CODES = np.arange(256) / 255.0
SRGB_TO_LINEAR: Float32[np.ndarray, "256"] = np.where(
    _CODES <= 0.04045, _CODES / 12.92, ((_CODES + 0.055) / 1.055) ** 2.4
).astype(np.float32)


def linear_to_srgb(linear: np.ndarray) -> np.ndarray:
    """Encode light (0 to 1, any shape) as sRGB (0 to 1)."""
    light = np.clip(linear, 0.0, 1.0)
    return np.where(light <= 0.0031308, light * 12.92, 1.055 * light ** (1.0 / 2.4) - 0.055)


_ENCODE_STEPS = 8192
_STRIP_ROWS = 512
"""Rows of an image that are processed at once: intermediate values take much more memory."""
_LINEAR_TO_CODE = np.rint(
    linear_to_srgb((np.arange(_ENCODE_STEPS) / (_ENCODE_STEPS - 1)) ** 2) * 255.0
).astype(np.uint8)


class TextureSet(NamedTuple):
    """All textures of a scene, ready for the shading kernel.

    Attributes:
        of_material: Texture of every material, -1 where it has none.
        texels: ``red | green << 8 | blue << 16 | opacity << 24``, all levels one after the other.
        levels: ``(first texel, width, height)`` of every texture and level.
        level_count: Levels of every texture.
    """

    of_material: Int32[np.ndarray, "materials"]
    texels: UInt32[np.ndarray, "texels"]
    levels: Int64[np.ndarray, "textures levels 3"]
    level_count: Int32[np.ndarray, "textures"]


def textures_of(scene: Scene, budget_mb: float) -> TextureSet:
    """The mip maps of a scene's textures, by `collect_textures`; they are kept in its cache."""
    name = f"textures-{_version()}-{budget_mb:g}"
    arrays = kept_arrays(
        scene.cache, name, lambda: collect_textures(scene.materials, budget_mb)._asdict()
    )
    return TextureSet(**arrays)


@lru_cache(maxsize=1)
def _version() -> str:
    return digest_of([Path(__file__), Path(texture_kernels.__file__)])


def collect_textures(materials: Sequence[Material], budget_mb: float) -> TextureSet:
    """Build the mip maps of all materials' textures.

    Materials that share an image share its texels. If all images together exceed the budget,
    the finest level of the largest ones is left out until they fit.

    Args:
        materials: Materials of a scene.
        budget_mb: Memory for texels, megabytes.
    """
    sources: list[Material] = []
    numbers: dict[tuple[int, int], int] = {}
    of_material = np.full(len(materials), -1, dtype=np.int32)
    for index, material in enumerate(materials):
        if material.texture is not None:
            key = (id(material.texture), id(material.opaque))
            if key not in numbers:
                numbers[key] = len(sources)
                sources.append(material)
            of_material[index] = numbers[key]
    sizes = [_sizes(source) for source in sources]
    _fit_to_budget(sizes, int(budget_mb * 1e6 / 4))
    levels = _places(sizes)
    counts = np.array([len(own) for own in sizes] or [1], dtype=np.int32)
    texels = np.zeros(max(sum(width * height for own in sizes for width, height in own), 1), "<u4")
    with ThreadPoolExecutor() as pool:
        list(pool.map(partial(_fill, texels), sources, levels, counts.tolist()))
    return TextureSet(of_material, texels.astype(np.uint32, copy=False), levels, counts)


def _places(textures: list[list[tuple[int, int]]]) -> Int64[np.ndarray, "textures levels 3"]:
    """First texel, width and height of every texture and level."""
    depth = max((len(sizes) for sizes in textures), default=1)
    table = np.zeros((max(len(textures), 1), depth, 3), dtype=np.int64)
    start = 0
    for number, sizes in enumerate(textures):
        for level, (width, height) in enumerate(sizes):
            table[number, level] = (start, width, height)
            start += width * height
    return table


def _sizes(material: Material) -> list[tuple[int, int]]:
    """Width and height of a texture in all its sizes, finest first."""
    assert material.texture is not None
    height, width = material.texture.shape[:2]
    sizes = [(width, height)]
    while max(width, height) > 1:
        width, height = max(width // 2, 1), max(height // 2, 1)
        sizes.append((width, height))
    return sizes


def _fill(
    texels: UInt32[np.ndarray, " texels"],
    material: Material,
    places: Int64[np.ndarray, "levels 3"],
    count: int,
) -> None:
    """Fill in a number of the smallest sizes of one texture, finest first."""
    assert material.texture is not None
    sizes = _sizes(material)
    left_out = len(sizes) - count
    levels = [texels[first : first + w * h].reshape(h, w) for first, w, h in places.tolist()]
    if left_out == 0:
        opaque = 1 if material.opaque is None else material.opaque
        _pack(material.texture, np.uint8(255) * opaque, levels[0])
    light = opacity = np.empty(0, np.float32)
    for number, size in enumerate(sizes[1:], start=1):
        if number == 1:
            light, opacity = _first_halving(material.texture, material.opaque, size)
        else:
            light, opacity = _halved(light, size), _halved(opacity, size)
        if number >= left_out:
            hidden = None if material.opaque is None else opacity
            _code(light, hidden, levels[number - left_out])


def _first_halving(
    codes: UInt8[np.ndarray, "height width 3"],
    opaque: Bool[np.ndarray, "height width"] | None,
    size: tuple[int, int],
) -> tuple[Float32[np.ndarray, "rows columns 3"], Float32[np.ndarray, "rows columns"]]:
    """Light and opacity of a texture at half its size.

    Light is weighted by opacity, so that the hidden colour of holes doesn't bleed into the leaves.
    Strips of an image of even sides are halved one by one: its light takes four times its memory.
    """
    height, width = codes.shape[:2]
    if opaque is None and height % 2 == 0 and width % 2 == 0:
        light = np.empty((size[1], size[0], 3), np.float32)
        codes = codes.view()
        codes.flags.writeable = False  # or the kernel is compiled for both kinds of textures
        halve(codes, SRGB_TO_LINEAR, light)
        return light, np.ones((size[1], size[0]), np.float32)
    rows = _STRIP_ROWS if height % 2 == 0 and width % 2 == 0 else height
    light = np.empty((size[1], size[0], 3), np.float32)
    opacity = np.ones((size[1], size[0]), np.float32)
    for top in range(0, height, rows):
        strip = slice(top, min(top + rows, height))
        half = slice(top // 2, max(strip.stop // 2, 1))
        full = SRGB_TO_LINEAR[codes[strip]]
        half_size = (size[0], half.stop - half.start)
        if opaque is not None:
            weight = opaque[strip].astype(np.float32)
            full *= weight[..., None]
            opacity[half] = _halved(weight, half_size)
        light[half] = _halved(full, half_size)
    return light, opacity


def _halved(values: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    halved = cv2.resize(values, size, interpolation=cv2.INTER_AREA)
    return halved.reshape(size[1], size[0], *values.shape[2:])


def _code(
    light: Float32[np.ndarray, "height width 3"],
    opacity: Float32[np.ndarray, "height width"] | None,
    level: UInt32[np.ndarray, "height width"],
) -> None:
    """Fill in a level by its light and opacity, which is None if all is opaque."""
    if opacity is not None:
        _pack(_encode(light, opacity), np.rint(opacity * 255.0), level)
        return
    codes = np.empty(light.shape, np.uint8)
    encode(light, _LINEAR_TO_CODE, codes)
    _pack(codes, np.uint8(255), level)


def _encode(
    light: Float32[np.ndarray, "height width 3"], opacity: Float32[np.ndarray, "height width"]
) -> UInt8[np.ndarray, "height width 3"]:
    """SRGB codes by table; indexed by the square root, where the codes lie evenly."""
    codes = np.empty(light.shape, np.uint8)
    for top in range(0, len(light), _STRIP_ROWS):
        strip = slice(top, top + _STRIP_ROWS)
        own = light[strip] / np.maximum(opacity[strip], 1e-6)[..., None]
        index = np.sqrt(np.clip(own, 0.0, 1.0)) * (_ENCODE_STEPS - 1) + 0.5
        codes[strip] = _LINEAR_TO_CODE[index.astype(np.int32)]
    return codes


def _pack(
    codes: UInt8[np.ndarray, "height width 3"],
    opacity: np.ndarray | np.uint8,
    level: UInt32[np.ndarray, "height width"],
) -> None:
    """Fill in colours with their opacity, 0 to 255."""
    rgba = level.view(np.uint8).reshape(*level.shape, 4)
    rgba[..., :3] = codes
    rgba[..., 3] = opacity


def _fit_to_budget(textures: list[list[tuple[int, int]]], budget_texels: int) -> None:
    """Drop finest levels, largest first, until the budget holds; changes the lists in place."""
    total = sum(width * height for sizes in textures for width, height in sizes)
    while total > budget_texels:
        largest = max(textures, key=lambda sizes: math.prod(sizes[0]))
        if len(largest) == 1:
            return
        total -= math.prod(largest.pop(0))
