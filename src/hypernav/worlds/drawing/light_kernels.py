"""Light gathered around positions, and applied to surfaces (numba kernels).

`light` is the third of three passes from rays to colours, see `geometry_kernels`.
"""

# The values of a cell are set when it changes, so also at the first one.
# pyright: reportPossiblyUnboundVariable=false

import numpy as np
from numba import njit
from numba.extending import register_jitable

from hypernav.worlds.drawing.base_color_kernels import FLAG_UNLIT
from hypernav.worlds.drawing.geometry_kernels import FACING, NORMAL, POINT

TONE_STEPS = 8192


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
