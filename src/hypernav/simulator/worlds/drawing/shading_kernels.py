"""Colours of surfaces: base colours, the light around them, and both together (numba kernels).

`fill_base_colors` and `light` are the second and third of three passes from rays to colours, see
`ray_kernels`.
"""

# The values of a material are set when it changes, so also at the first one.
# pyright: reportPossiblyUnboundVariable=false
# The values of a cell are set when it changes, so also at the first one.

import math

import numpy as np
from numba import njit
from numba.extending import register_jitable

from hypernav.simulator.worlds.drawing.ray_kernels import (
    FACING,
    NORMAL,
    POINT,
    UV,
    UV_DOWN,
    UV_RIGHT,
    WEIGHT,
)
from hypernav.simulator.worlds.drawing.texture_kernels import (
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
TONE_STEPS = 8192


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


@register_jitable(error_model="numpy", no_cfunc_wrapper=True)
def _towards(nodes, node, nx, ny, nz):
    """Light that falls from one node on a surface with this normal, 0 to 255."""
    x_side = nodes[node + (0 if nx > 0.0 else 1)]
    y_side = nodes[node + (2 if ny > 0.0 else 3)]
    z_side = nodes[node + (4 if nz > 0.0 else 5)]
    return nx * nx * x_side + ny * ny * y_side + nz * nz * z_side


@njit(cache=True, nogil=True, error_model="numpy")
def light(
    hits,
    surface,
    colors,
    face_material,
    material_flags,
    nodes,
    shape,
    origin,
    cell_m,
    shares,
    tone,
    background,
    rgb,
    wanted,
):
    """Third pass: the colour as lit and as shown.

    Args:
        hits: Triangle of every ray, -1 for none, int32 [rays].
        surface: As filled by `locate`.
        colors: As filled by `fill_base_colors`.
        face_material: See `Scene`.
        material_flags: ``FLAG_…`` of every material, uint8 [materials].
        nodes: Light around the surfaces, see `LightGrid`, as a flat list.
        shape: Shape of the nodes: layers, rows, columns, bytes.
        origin: Position of the first node, float64 [3].
        cell_m: Distance between nodes.
        shares: Weights of the light of the nodes and of the headlight, float64 [2].
        tone: sRGB code of light, uint8 [TONE_STEPS].
        background: Colour where nothing is hit, uint8 [3].
        rgb: Output: colours, uint8 [rays, 3].
        wanted: Output: lowest nodes of cells whose light is not known yet, int64 [rays].

    Returns:
        Number of wanted cells; the colours that need them are wrong.
    """
    missing = 0
    ox, oy, oz, per_m = origin[0], origin[1], origin[2], 1.0 / cell_m
    rows, columns = shape[1], shape[2]
    row, layer = 8 * columns, 8 * rows * columns
    last, last_x, last_y, last_z = -1, np.float32(0.0), np.float32(0.0), np.float32(0.0)
    limit_x, limit_y, limit_z = columns - 1.001, rows - 1.001, shape[0] - 1.001
    for ray in range(hits.shape[0]):
        face = hits[ray]
        if face < 0:
            for channel in range(3):
                rgb[ray, channel] = background[channel]
            continue
        if material_flags[face_material[face]] & FLAG_UNLIT:
            for channel in range(3):
                rgb[ray, channel] = np.uint8(min(colors[ray, channel] + 0.5, 255.0))
            continue
        nx, ny, nz = surface[ray, NORMAL], surface[ray, NORMAL + 1], surface[ray, NORMAL + 2]
        # So far in front of the surface that no node behind it has any weight.
        lift = abs(nx) + abs(ny) + abs(nz)
        x = (surface[ray, POINT] - ox) * per_m + nx * lift
        y = (surface[ray, POINT + 1] - oy) * per_m + ny * lift
        z = (surface[ray, POINT + 2] - oz) * per_m + nz * lift
        x = min(x, limit_x) if x >= 0.0 else 0.0
        y = min(y, limit_y) if y >= 0.0 else 0.0
        z = min(z, limit_z) if z >= 0.0 else 0.0
        ix, iy, iz = int(x), int(y), int(z)
        fx, fy, fz = x - ix, y - iy, z - iz
        at = ((iz * rows + iy) * columns + ix) * 8
        if at != last or nx != last_x or ny != last_y or nz != last_z:
            # Mostly the next ray meets the same cell under the same normal.
            last, last_x, last_y, last_z = at, nx, ny, nz
            known = nodes[at + 7] & nodes[at + 15] & nodes[at + row + 7] & nodes[at + row + 15]
            up = at + layer
            known &= nodes[up + 7] & nodes[up + 15] & nodes[up + row + 7] & nodes[up + row + 15]
            if known == 0:
                wanted[missing] = at // 8
                missing += 1
            a = _towards(nodes, at, nx, ny, nz)
            a_x = _towards(nodes, at + 8, nx, ny, nz) - a
            b = _towards(nodes, at + row, nx, ny, nz)
            b_x = _towards(nodes, at + row + 8, nx, ny, nz) - b
            c = _towards(nodes, up, nx, ny, nz)
            c_x = _towards(nodes, up + 8, nx, ny, nz) - c
            d = _towards(nodes, up + row, nx, ny, nz)
            d_x = _towards(nodes, up + row + 8, nx, ny, nz) - d
        low = a + fx * a_x
        low += fy * (b + fx * b_x - low)
        high = c + fx * c_x
        high += fy * (d + fx * d_x - high)
        total = low + fz * (high - low)
        shine = shares[0] * total / 255.0 + shares[1] * surface[ray, FACING]
        for channel in range(3):
            code = colors[ray, channel] * (1.0 / 255.0)
            # Light of an sRGB code: a polynomial within 0.002 of the standard's curve.
            linear = code * (code * (code * 0.305306011 + 0.682171111) + 0.012522878)
            step = int(shine * linear * (TONE_STEPS - 1) + 0.5)
            rgb[ray, channel] = tone[max(min(step, TONE_STEPS - 1), 0)]
    return missing


@njit(cache=True, nogil=True, error_model="numpy")
def gather_light(distances, directions, sky, reach_m, contrast, result):
    """Light from each of the six sides of every position.

    Args:
        distances: Distance to the first hit along every direction, float32 [directions, positions];
            negative or over `reach_m` if it is farther.
        directions: Unit vectors, float32 [directions, 3].
        sky: Light that arrives from every direction where nothing is hit, [directions].
        reach_m: Distance beyond which a hit does not block light.
        contrast: Exponent of the light; above 1 deepens the shade.
        result: Output: light from +x, -x, +y, -y, +z, -z, uint8 [positions, 6].
    """
    sums = np.zeros(6)
    for position in range(distances.shape[1]):
        sums[:] = 0.0
        for ray in range(distances.shape[0]):
            distance = distances[ray, position]
            near = distance / reach_m if 0.0 <= distance < reach_m else 1.0
            light = sky[ray] * near
            for axis in range(3):
                along = directions[ray, axis]
                if along > 0.0:
                    sums[2 * axis] += light * along
                else:
                    sums[2 * axis + 1] -= light * along
        # The directions are spread evenly: the cosines of one half sum up to a quarter of them.
        scale = 4.0 / distances.shape[0]
        for side in range(6):
            light = min(sums[side] * scale, 1.0) ** contrast
            result[position, side] = np.uint8(light * 255.0 + 0.5)
