"""Light: gathered around places, and shown on surfaces. Compiled.

`light` is the third of three passes from rays to colours, see `geometry_kernels`.
"""

import numpy as np
from numba import njit

from hypernav.worlds.geometry_kernels import FACING, NORMAL, POINT
from hypernav.worlds.paint_kernels import FLAG_UNLIT

TONE_STEPS = 8192


@njit(cache=True, nogil=True, error_model="numpy")
def _at_node_cell(nodes, at, columns, layer, fx, fy, fz):
    """One byte of the eight nodes of a cell, interpolated."""
    row = 8 * columns
    a = nodes[at] + fx * (np.int64(nodes[at + 8]) - nodes[at])
    b = nodes[at + row] + fx * (np.int64(nodes[at + row + 8]) - nodes[at + row])
    at += layer
    c = nodes[at] + fx * (np.int64(nodes[at + 8]) - nodes[at])
    d = nodes[at + row] + fx * (np.int64(nodes[at + row + 8]) - nodes[at + row])
    low, high = a + fy * (b - a), c + fy * (d - c)
    return low + fz * (high - low)


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
        colors: As filled by `paint`.
        face_material: See `Scene`.
        material_flags: ``FLAG_…`` of every material, uint8 [materials].
        nodes: Light around the surfaces, see `LightGrid`, as a flat list.
        shape: Of the nodes: layers, rows, columns, bytes.
        origin: Place of the first node, float64 [3].
        cell_m: Distance of nodes.
        shares: Of the light of the nodes and of the headlight, float64 [2].
        tone: sRGB code of light, uint8 [TONE_STEPS].
        background: Colour where nothing is hit, uint8 [3].
        rgb: Filled, uint8 [rays, 3].
        wanted: Filled with the lowest node of cells whose light is not known yet, int64 [rays].

    Returns:
        How many cells were wanted; the colours that need them are wrong.
    """
    missing = 0
    ox, oy, oz, per_m = origin[0], origin[1], origin[2], 1.0 / cell_m
    rows, columns = shape[1], shape[2]
    layer = 8 * rows * columns
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
        # So far in front of the surface that no node behind it has a say.
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
        known = 1
        for corner in (7, 15, 8 * columns + 7, 8 * columns + 15):
            known &= nodes[at + corner] & nodes[at + layer + corner]
        if known == 0 and (missing == 0 or wanted[missing - 1] != at // 8):
            wanted[missing] = at // 8
            missing += 1
        x_side = _at_node_cell(nodes, at + (0 if nx > 0.0 else 1), columns, layer, fx, fy, fz)
        y_side = _at_node_cell(nodes, at + (2 if ny > 0.0 else 3), columns, layer, fx, fy, fz)
        z_side = _at_node_cell(nodes, at + (4 if nz > 0.0 else 5), columns, layer, fx, fy, fz)
        total = nx * nx * x_side + ny * ny * y_side + nz * nz * z_side
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
    """Light from each of the six sides of every place.

    Args:
        distances: To the first thing along every direction, float32 [directions, places];
            negative or over `reach_m` where it is farther.
        directions: Unit vectors, float32 [directions, 3].
        sky: Light that arrives from every direction where nothing is in the way, [directions].
        reach_m: A thing this far away takes no light.
        contrast: Exponent of the light; above 1 deepens the shade.
        result: Filled with light from +x, -x, +y, -y, +z, -z, uint8 [places, 6].
    """
    sums = np.zeros(6)
    for place in range(distances.shape[1]):
        sums[:] = 0.0
        for ray in range(distances.shape[0]):
            distance = distances[ray, place]
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
            result[place, side] = np.uint8(light * 255.0 + 0.5)
