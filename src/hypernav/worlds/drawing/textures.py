"""Textures in the renderer's form: one flat array that holds every image in every size.

Each image is followed by its halvings down to one texel (mip maps), so that a surface far away
is read from an image whose texels are as large as the pixels. Halving averages light, not sRGB
numbers: a distant black and white checkerboard has the brightness of the real thing.
"""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import cv2
import numpy as np
from jaxtyping import Float32, Int32, Int64, UInt8, UInt32

from hypernav.worlds.scenes.scene import Material

_CODES = np.arange(256) / 255.0
SRGB_TO_LINEAR: Float32[np.ndarray, "256"] = np.where(
    _CODES <= 0.04045, _CODES / 12.92, ((_CODES + 0.055) / 1.055) ** 2.4
).astype(np.float32)


def linear_to_srgb(linear: np.ndarray) -> np.ndarray:
    """Encode light (0 to 1, any shape) as sRGB (0 to 1)."""
    light = np.clip(linear, 0.0, 1.0)
    return np.where(light <= 0.0031308, light * 12.92, 1.055 * light ** (1.0 / 2.4) - 0.055)


_ENCODE_STEPS = 8192
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
    with ThreadPoolExecutor() as pool:
        pyramids = list(pool.map(_pyramid, sources))
    _fit_to_budget(pyramids, int(budget_mb * 1e6 / 4))
    return _pack(pyramids, of_material)


def _pyramid(material: Material) -> list[UInt32[np.ndarray, "height width"]]:
    """One texture in all its sizes, finest first."""
    assert material.texture is not None
    codes = material.texture
    opacity = np.ones(codes.shape[:2], dtype=np.float32)
    if material.opaque is not None:
        opacity = material.opaque.astype(np.float32)
    levels = [_packed(codes, opacity)]
    # Weighted by opacity, so that the hidden colour of holes doesn't bleed into the leaves.
    light = SRGB_TO_LINEAR[codes] * opacity[..., None]
    while max(light.shape[:2]) > 1:
        size = (max(light.shape[1] // 2, 1), max(light.shape[0] // 2, 1))
        light = cv2.resize(light, size, interpolation=cv2.INTER_AREA).reshape(size[1], size[0], 3)
        opacity = cv2.resize(opacity, size, interpolation=cv2.INTER_AREA).reshape(size[::-1])
        levels.append(_packed(_encode(light / np.maximum(opacity, 1e-6)[..., None]), opacity))
    return levels


def _encode(light: Float32[np.ndarray, "height width 3"]) -> UInt8[np.ndarray, "height width 3"]:
    """SRGB codes by table; indexed by the square root, where the codes lie evenly."""
    index = np.sqrt(np.clip(light, 0.0, 1.0)) * (_ENCODE_STEPS - 1) + 0.5
    return _LINEAR_TO_CODE[index.astype(np.int32)]


def _packed(
    codes: UInt8[np.ndarray, "height width 3"], opacity: Float32[np.ndarray, "height width"]
) -> UInt32[np.ndarray, "height width"]:
    rgba = np.empty((*codes.shape[:2], 4), dtype=np.uint8)
    rgba[..., :3] = codes
    rgba[..., 3] = np.rint(opacity * 255.0)
    return rgba.view("<u4")[..., 0].astype(np.uint32)


def _fit_to_budget(pyramids: list[list[np.ndarray]], budget_texels: int) -> None:
    """Drop finest levels, largest first, until the budget holds; changes the lists in place."""
    total = sum(level.size for levels in pyramids for level in levels)
    while total > budget_texels:
        largest = max(pyramids, key=lambda levels: levels[0].size)
        if len(largest) == 1:
            return
        total -= largest.pop(0).size


def _pack(pyramids: list[list[np.ndarray]], of_material: Int32[np.ndarray, "m"]) -> TextureSet:
    depth = max((len(levels) for levels in pyramids), default=1)
    table = np.zeros((max(len(pyramids), 1), depth, 3), dtype=np.int64)
    counts = np.ones(max(len(pyramids), 1), dtype=np.int32)
    start = 0
    for number, levels in enumerate(pyramids):
        counts[number] = len(levels)
        for index, level in enumerate(levels):
            table[number, index] = (start, level.shape[1], level.shape[0])
            start += level.size
    flat = [level.ravel() for levels in pyramids for level in levels]
    texels = np.concatenate(flat) if flat else np.zeros(1, dtype=np.uint32)
    return TextureSet(of_material, texels, table, counts)
