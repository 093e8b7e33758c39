"""Base colours of surfaces, without light: material, vertex colours, textures (numba kernels).

Second of three passes from rays to colours, see `geometry_kernels`.
"""

# The values of a material are set when it changes, so also at the first one.
# pyright: reportPossiblyUnboundVariable=false

import math

import numpy as np
from numba import njit
from numba.extending import register_jitable

from hypernav.worlds.drawing.geometry_kernels import UV, UV_DOWN, UV_RIGHT, WEIGHT
from hypernav.worlds.drawing.texel_kernels import (
    HEIGHT,
    LEVEL_ROWS,
    READ_ROWS,
    RED,
    SHARE,
    WIDTH,
    WRAP_U,
    WRAP_V,
    U,
    V,
    read_texels,
    wrapped,
)

MAX_TAPS = 4
_MOST_READS = 2 * MAX_TAPS
_RAYS = 256
"""Rays whose textures are read at once: their positions stay in the processor's cache."""
FLAG_UNLIT = 1
FLAG_CUTOUT = 2
FLAG_COLORED = 4


@register_jitable(error_model="numpy", no_cfunc_wrapper=True)
def _footprint(surface, ray, width, height, coarsest):
    """How a texture is read for one ray.

    Args:
        surface: As filled by `locate`.
        ray: Number of the ray.
        width: Width of the texture's finest level, texels.
        height: Its height.
        coarsest: Number of its coarsest level.

    Returns:
        Number of samples; finer of the two levels to read; weight of the coarser one; change of
        texture coordinates along the longer axis of the pixel's footprint.
    """
    du, dv = surface[ray, UV_RIGHT], surface[ray, UV_RIGHT + 1]
    eu, ev = surface[ray, UV_DOWN], surface[ray, UV_DOWN + 1]
    long = math.sqrt((du * width) ** 2 + (dv * height) ** 2)
    short = math.sqrt((eu * width) ** 2 + (ev * height) ** 2)
    if long < short:
        long, short, du, dv = short, long, eu, ev
    taps, level, blend = 1, 0, 0.0
    if long > 1.0:
        if long > 1.5 * short:
            taps = int(min(long / max(short, 1e-9) + 0.5, MAX_TAPS))
        size = max(long / taps, short, 1.0)
        while size >= 1.6 and level < coarsest:
            size *= 0.5
            level += 1
        if level < coarsest:
            blend = max((size - 1.35) * 4.0, 0.0)
    return taps, level, blend, du, dv


@njit(cache=True, nogil=True, error_model="numpy")
def fill_base_colors(
    hits,
    surface,
    colors,
    face_material,
    material_flags,
    material_color,
    material_wrap,
    material_texture,
    texels,
    levels,
    level_count,
    rgb,
):
    """Second pass: colour of the surfaces, without light.

    A texture is read over the footprint of the pixel: the shorter axis of the footprint selects
    the level, and up to `MAX_TAPS` samples are taken along the longer one.

    Args:
        hits: Triangle of every ray, -1 for none, int32 [rays].
        surface: As filled by `locate`.
        colors: See `Scene`.
        face_material: See `Scene`.
        material_flags: ``FLAG_…`` of every material, uint8 [materials].
        material_color: Colours, sRGB 0 to 1, float32 [materials, 3].
        material_wrap: Modes of `Wrap` along u and v, uint8 [materials, 2].
        material_texture: See `TextureSet.of_material`.
        texels: See `TextureSet`.
        levels: See `TextureSet`.
        level_count: See `TextureSet`.
        rgb: Output where a triangle is hit: sRGB codes 0 to 255, float32 [rays, 3].
    """
    reads = np.empty((READ_ROWS, _RAYS * _MOST_READS))
    of_level = np.empty((LEVEL_ROWS, _RAYS * _MOST_READS), np.int32)
    first_texels = np.empty(_RAYS * _MOST_READS, np.int64)
    ends = np.empty(_RAYS, np.int64)
    last = -1
    for start in range(0, hits.shape[0], _RAYS):
        stop = min(start + _RAYS, hits.shape[0])
        count = np.int64(0)  # for a literal 0 `read_texels` would be compiled once more
        for ray in range(start, stop):
            face = hits[ray]
            if face >= 0 and face_material[face] != last:
                material = last = face_material[face]
                wrap_u, wrap_v = material_wrap[material, 0], material_wrap[material, 1]
                texture = material_texture[material]
                coarsest = level_count[texture] - 1
                width, height = levels[texture, 0, 1], levels[texture, 0, 2]
            if face >= 0 and texture >= 0:
                taps, level, blend, du, dv = _footprint(surface, ray, width, height, coarsest)
                for tap in range(taps):
                    at = (tap + 0.5) / taps - 0.5
                    share = (1.0 - blend) / (255.0 * taps)
                    for near in range(2 if blend > 0.0 else 1):
                        reads[U, count] = surface[ray, UV] + du * at
                        reads[V, count] = surface[ray, UV + 1] + dv * at
                        reads[SHARE, count] = share
                        first_texels[count] = levels[texture, level + near, 0]
                        of_level[WIDTH, count] = levels[texture, level + near, 1]
                        of_level[HEIGHT, count] = levels[texture, level + near, 2]
                        of_level[WRAP_U, count], of_level[WRAP_V, count] = wrap_u, wrap_v
                        share = blend / (255.0 * taps)
                        count += 1
            ends[ray - start] = count
        read_texels(texels, count, first_texels, reads, of_level)
        read = 0
        for ray in range(start, stop):
            face = hits[ray]
            if face < 0:
                continue
            material, end = face_material[face], ends[ray - start]
            colored = material_flags[material] & FLAG_COLORED
            for channel in range(3):
                code = 255.0 * material_color[material, channel]
                if colored:
                    second, third = surface[ray, WEIGHT] / 255.0, surface[ray, WEIGHT + 1] / 255.0
                    first = 1.0 / 255.0 - second - third
                    a, b, c = (
                        colors[face, 0, channel],
                        colors[face, 1, channel],
                        colors[face, 2, channel],
                    )
                    code *= first * a + second * b + third * c
                if read < end:
                    total = 0.0
                    for own in range(read, end):
                        total += reads[RED + channel, own]
                    code *= total
                rgb[ray, channel] = code
            read = end


@njit(cache=True, nogil=True, error_model="numpy")
def find_holes(
    hits,
    surface,
    face_material,
    material_flags,
    material_wrap,
    material_texture,
    texels,
    levels,
    holes,
):
    """Rays that went through a hole in a texture, such as the gaps between leaves.

    Args:
        hits: Triangle of every ray, -1 for none, int32 [rays].
        surface: As filled by `locate`.
        face_material: See `Scene`.
        material_flags: ``FLAG_…`` of every material, uint8 [materials].
        material_wrap: Modes of `Wrap` along u and v, uint8 [materials, 2].
        material_texture: See `TextureSet.of_material`.
        texels: See `TextureSet`.
        levels: See `TextureSet`.
        holes: Output: numbers of the rays, int64 [rays].

    Returns:
        Number of rays through holes.
    """
    count = 0
    for ray in range(hits.shape[0]):
        face = hits[ray]
        if face < 0:
            continue
        material = face_material[face]
        if material_flags[material] & FLAG_CUTOUT == 0:
            continue
        texture = material_texture[material]
        width, height = levels[texture, 0, 1], levels[texture, 0, 2]
        x = int(wrapped(surface[ray, UV], material_wrap[material, 0]) * width)
        y = int((1.0 - wrapped(surface[ray, UV + 1], material_wrap[material, 1])) * height)
        texel = levels[texture, 0, 0] + min(y, height - 1) * width + min(x, width - 1)
        if texels[texel] >> 24 < 128:
            holes[count] = ray
            count += 1
    return count
