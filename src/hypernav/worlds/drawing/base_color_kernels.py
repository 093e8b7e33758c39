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

MAX_TAPS = 4
FLAG_UNLIT = 1
FLAG_CUTOUT = 2
FLAG_COLORED = 4


@register_jitable(error_model="numpy", no_cfunc_wrapper=True)
def wrapped(coordinate, mode):
    """A texture coordinate mapped into [0, 1]; modes are those of `Wrap`."""
    if mode == 0:
        inside = coordinate - math.floor(coordinate)
    elif mode == 1:
        inside = coordinate - 2.0 * math.floor(coordinate * 0.5)
        if inside > 1.0:
            inside = 2.0 - inside
    else:
        inside = min(max(coordinate, 0.0), 1.0)
    # A surface seen exactly edge-on gives infinite steps, and those NaN.
    return inside if 0.0 <= inside <= 1.0 else 0.0


@register_jitable(error_model="numpy", no_cfunc_wrapper=True)
def _bilinear(texels, first, width, height, u, v, wrap_u, wrap_v):
    """Colour of one level of a texture, sRGB codes 0 to 255; v upwards."""
    x = wrapped(u, wrap_u) * width - 0.5
    y = (1.0 - wrapped(v, wrap_v)) * height - 0.5
    x0, y0 = math.floor(x), math.floor(y)
    wx, wy = x - x0, y - y0
    x1, y1 = x0 + 1, y0 + 1
    if x0 < 0:
        x0 = width - 1 if wrap_u == 0 else 0
    if x1 >= width:
        x1 = 0 if wrap_u == 0 else width - 1
    if y0 < 0:
        y0 = height - 1 if wrap_v == 0 else 0
    if y1 >= height:
        y1 = 0 if wrap_v == 0 else height - 1
    # Weights in 1/65536. Red and blue are the two halves of one number, green is another.
    right, below = int(wx * 256.0 + 0.5), int(wy * 256.0 + 0.5)
    left, above = 256 - right, 256 - below
    texel = np.int64(texels[first + y0 * width + x0])
    weight = left * above
    red_blue = weight * ((texel & 255) | ((texel & 0xFF0000) << 16))
    green = weight * ((texel >> 8) & 255)
    texel = np.int64(texels[first + y0 * width + x1])
    weight = right * above
    red_blue += weight * ((texel & 255) | ((texel & 0xFF0000) << 16))
    green += weight * ((texel >> 8) & 255)
    texel = np.int64(texels[first + y1 * width + x0])
    weight = left * below
    red_blue += weight * ((texel & 255) | ((texel & 0xFF0000) << 16))
    green += weight * ((texel >> 8) & 255)
    texel = np.int64(texels[first + y1 * width + x1])
    weight = right * below
    red_blue += weight * ((texel & 255) | ((texel & 0xFF0000) << 16))
    green += weight * ((texel >> 8) & 255)
    return (red_blue & 0xFFFFFFFF) / 65536.0, green / 65536.0, (red_blue >> 32) / 65536.0


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
    last = -1
    for ray in range(hits.shape[0]):
        face = hits[ray]
        if face < 0:
            continue
        if face_material[face] != last:
            material = last = face_material[face]
            colored = material_flags[material] & FLAG_COLORED
            base_red = 255.0 * material_color[material, 0]
            base_green = 255.0 * material_color[material, 1]
            base_blue = 255.0 * material_color[material, 2]
            wrap_u, wrap_v = material_wrap[material, 0], material_wrap[material, 1]
            texture = material_texture[material]
            coarsest = level_count[texture] - 1
            width, height = levels[texture, 0, 1], levels[texture, 0, 2]
        red, green, blue = base_red, base_green, base_blue
        if colored:
            second, third = surface[ray, WEIGHT] / 255.0, surface[ray, WEIGHT + 1] / 255.0
            first = 1.0 / 255.0 - second - third
            a, b, c = colors[face, 0, 0], colors[face, 1, 0], colors[face, 2, 0]
            red *= first * a + second * b + third * c
            a, b, c = colors[face, 0, 1], colors[face, 1, 1], colors[face, 2, 1]
            green *= first * a + second * b + third * c
            a, b, c = colors[face, 0, 2], colors[face, 1, 2], colors[face, 2, 2]
            blue *= first * a + second * b + third * c
        if texture < 0:
            rgb[ray, 0], rgb[ray, 1], rgb[ray, 2] = red, green, blue
            continue
        u, v = surface[ray, UV], surface[ray, UV + 1]
        du, dv = surface[ray, UV_RIGHT], surface[ray, UV_RIGHT + 1]
        eu, ev = surface[ray, UV_DOWN], surface[ray, UV_DOWN + 1]
        long = math.sqrt((du * width) ** 2 + (dv * height) ** 2)
        short = math.sqrt((eu * width) ** 2 + (ev * height) ** 2)
        if long < short:
            long, short, du, dv = short, long, eu, ev
        taps = 1
        level = 0
        blend = 0.0
        if long > 1.0:
            if long > 1.5 * short:
                taps = int(min(long / max(short, 1e-9) + 0.5, MAX_TAPS))
            size = max(long / taps, short, 1.0)
            while size >= 1.6 and level < coarsest:
                size *= 0.5
                level += 1
            if level < coarsest:
                blend = max((size - 1.35) * 4.0, 0.0)
        texture_red, texture_green, texture_blue = 0.0, 0.0, 0.0
        for tap in range(taps):
            at = (tap + 0.5) / taps - 0.5
            share = (1.0 - blend) / (255.0 * taps)
            for near in range(2 if blend > 0.0 else 1):
                r, g, b = _bilinear(
                    texels,
                    levels[texture, level + near, 0],
                    levels[texture, level + near, 1],
                    levels[texture, level + near, 2],
                    u + du * at,
                    v + dv * at,
                    wrap_u,
                    wrap_v,
                )
                texture_red += share * r
                texture_green += share * g
                texture_blue += share * b
                share = blend / (255.0 * taps)
        rgb[ray, 0] = red * texture_red
        rgb[ray, 1] = green * texture_green
        rgb[ray, 2] = blue * texture_blue


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
