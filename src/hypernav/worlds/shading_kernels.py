"""From the triangles that rays hit to depth and colour, in three passes. Compiled.

Every pass goes over a flat list of rays and takes plain arrays: what is handed to an inner function
is copied for every pixel, so those get numbers only. The passes talk through `surface`, one row of
float32 per ray, whose columns are named below.
"""

import math

import numpy as np
from numba import njit

NORMAL = 0  # 3 columns, towards the camera
POINT = 3  # 3 columns, scene frame
FACING = 6  # cosine between the normal and the way back to the camera
WEIGHT = 7  # 2 columns: of the triangle's second and third corner
UV = 9  # 2 columns
UV_RIGHT = 11  # 2 columns: change of uv to the next pixel on the right
UV_DOWN = 13  # 2 columns: to the next pixel below
SURFACE_COLUMNS = 15

MAX_TAPS = 4
TONE_STEPS = 8192
FLAG_UNLIT = 1
FLAG_CUTOUT = 2
FLAG_COLORED = 4


@njit(cache=True, nogil=True, error_model="numpy")
def fill_rays(rotation, position, fx, fy, cx, cy, first_row, origins, directions):
    """Rays through the centres of pixels; 1 long along the optical axis.

    Args:
        rotation: Camera to scene, float64 [3, 3].
        position: Of the camera in the scene, float64 [3].
        fx: Focal length, pixels; likewise `fy`, `cx`, `cy`.
        first_row: Of the image, that the first row of rays belongs to.
        origins: Filled, float32 [rows, columns, 3].
        directions: Filled, float32 [rows, columns, 3].
    """
    for row in range(directions.shape[0]):
        y = (first_row + row + 0.5 - cy) / fy
        for column in range(directions.shape[1]):
            x = (column + 0.5 - cx) / fx
            for axis in range(3):
                origins[row, column, axis] = position[axis]
                directions[row, column, axis] = (
                    rotation[axis, 0] * x + rotation[axis, 1] * y + rotation[axis, 2]
                )


@njit(cache=True, nogil=True, error_model="numpy")
def locate(
    hits, directions, camera, vertices, faces, normals, uv, face_instance, depth, ids, surface
):
    """First pass: where on the triangles the rays end, and how the surface lies there.

    Args:
        hits: Triangle of every ray, -1 for none, int32 [rays].
        directions: Scene frame, 1 long along the optical axis, float32 [rays, 3].
        camera: Rows: position; optical axis; change of direction to the next pixel right; to the
            next pixel down; float64 [4, 3], scene frame.
        vertices: See `Scene`, as `faces`, `normals` (no rows where there are none), `uv` and
            `face_instance`.
        depth: Filled, 0 where nothing is hit, float32 [rays].
        ids: Filled, -1 where nothing is hit, int32 [rays].
        surface: Filled where a triangle is hit, float32 [rays, SURFACE_COLUMNS].
    """
    ox, oy, oz = camera[0, 0], camera[0, 1], camera[0, 2]
    zx, zy, zz = camera[1, 0], camera[1, 1], camera[1, 2]
    rx, ry, rz = camera[2, 0], camera[2, 1], camera[2, 2]
    lx, ly, lz = camera[3, 0], camera[3, 1], camera[3, 2]
    last = -1
    for ray in range(hits.shape[0]):
        face = hits[ray]
        if face < 0:
            depth[ray] = 0.0
            ids[ray] = -1
            continue
        if face != last:  # what holds for the whole triangle; the next ray mostly hits it again
            last = face
            instance = face_instance[face]
            i, j, k = faces[face, 0], faces[face, 1], faces[face, 2]
            # Corners as seen from the camera, edges from the first corner, normal (not unit).
            ax, ay, az = vertices[i, 0] - ox, vertices[i, 1] - oy, vertices[i, 2] - oz
            bx, by, bz = vertices[j, 0] - ox, vertices[j, 1] - oy, vertices[j, 2] - oz
            cx, cy, cz = vertices[k, 0] - ox, vertices[k, 1] - oy, vertices[k, 2] - oz
            ex, ey, ez = bx - ax, by - ay, bz - az
            fx, fy, fz = cx - ax, cy - ay, cz - az
            nx, ny, nz = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
            plane = nx * ax + ny * ay + nz * az
            da, db = zx * ax + zy * ay + zz * az, zx * bx + zy * by + zz * bz
            dc = zx * cx + zy * cy + zz * cz
            nearest, farthest = min(da, db, dc), max(da, db, dc)
            # A corner's weight is linear in space: one gradient gives its value and its change.
            square = max(nx * nx + ny * ny + nz * nz, 1e-60)
            mx, my, mz = nx / square, ny / square, nz / square
            gx, gy, gz = fy * mz - fz * my, fz * mx - fx * mz, fx * my - fy * mx
            hx, hy, hz = my * ez - mz * ey, mz * ex - mx * ez, mx * ey - my * ex
            g0, h0 = gx * ax + gy * ay + gz * az, hx * ax + hy * ay + hz * az
            au, av = uv[face, 0, 0], uv[face, 0, 1]
            eu, ev = uv[face, 1, 0] - au, uv[face, 1, 1] - av
            fu, fv = uv[face, 2, 0] - au, uv[face, 2, 1] - av
            # Change of texture coordinates in space, and of the normal's side along the pixels.
            ux, uy, uz = gx * eu + hx * fu, gy * eu + hy * fu, gz * eu + hz * fu
            vx, vy, vz = gx * ev + hx * fv, gy * ev + hy * fv, gz * ev + hz * fv
            right, down = nx * rx + ny * ry + nz * rz, nx * lx + ny * ly + nz * lz
            length = math.sqrt(square)
            kx, ky, kz = nx / length, ny / length, nz / length
            smooth = False
            for corner in range(normals.shape[1]):
                sx, sy, sz = (
                    normals[face, corner, 0],
                    normals[face, corner, 1],
                    normals[face, corner, 2],
                )
                smooth |= abs(sx * kx + sy * ky + sz * kz) < 0.9999
        dx, dy, dz = directions[ray, 0], directions[ray, 1], directions[ray, 2]
        along = 1.0 / (nx * dx + ny * dy + nz * dz)
        way = plane * along
        # Of a needle seen edge-on the plane is ill defined, but depth lies between its corners'.
        if not way >= nearest:  # "not" catches what is no number as well
            way = nearest
        way = min(way, farthest)
        depth[ray] = way
        ids[ray] = instance
        px, py, pz = way * dx, way * dy, way * dz
        surface[ray, POINT] = px + ox
        surface[ray, POINT + 1] = py + oy
        surface[ray, POINT + 2] = pz + oz
        second = min(max(px * gx + py * gy + pz * gz - g0, 0.0), 1.0)
        third = min(max(px * hx + py * hy + pz * hz - h0, 0.0), 1.0 - second)
        surface[ray, WEIGHT] = second
        surface[ray, WEIGHT + 1] = third
        surface[ray, UV] = au + second * eu + third * fu
        surface[ray, UV + 1] = av + second * ev + third * fv
        slide = right * along
        sx, sy, sz = way * (rx - slide * dx), way * (ry - slide * dy), way * (rz - slide * dz)
        surface[ray, UV_RIGHT] = sx * ux + sy * uy + sz * uz
        surface[ray, UV_RIGHT + 1] = sx * vx + sy * vy + sz * vz
        slide = down * along
        sx, sy, sz = way * (lx - slide * dx), way * (ly - slide * dy), way * (lz - slide * dz)
        surface[ray, UV_DOWN] = sx * ux + sy * uy + sz * uz
        surface[ray, UV_DOWN + 1] = sx * vx + sy * vy + sz * vz

        # The normal, unit length and turned to the side that is seen.
        side = -1.0 if along > 0.0 else 1.0
        mx, my, mz = kx * side, ky * side, kz * side
        if smooth:
            first = 1.0 - second - third
            a, b, c = normals[face, 0, 0], normals[face, 1, 0], normals[face, 2, 0]
            sx = first * a + second * b + third * c
            a, b, c = normals[face, 0, 1], normals[face, 1, 1], normals[face, 2, 1]
            sy = first * a + second * b + third * c
            a, b, c = normals[face, 0, 2], normals[face, 1, 2], normals[face, 2, 2]
            sz = first * a + second * b + third * c
            square = sx * sx + sy * sy + sz * sz
            if square > 1e-12:
                scale = 1.0 / math.sqrt(square)
                if sx * mx + sy * my + sz * mz < 0.0:
                    scale = -scale
                mx, my, mz = sx * scale, sy * scale, sz * scale
        surface[ray, NORMAL] = mx
        surface[ray, NORMAL + 1] = my
        surface[ray, NORMAL + 2] = mz
        facing = -(mx * dx + my * dy + mz * dz) / math.sqrt(dx * dx + dy * dy + dz * dz)
        surface[ray, FACING] = max(facing, 0.0)


@njit(cache=True, nogil=True, error_model="numpy")
def wrapped(coordinate, mode):
    """A texture coordinate brought into [0, 1]; modes are those of `Wrap`."""
    if mode == 0:
        return coordinate - math.floor(coordinate)
    if mode == 1:
        folded = coordinate - 2.0 * math.floor(coordinate * 0.5)
        return 2.0 - folded if folded > 1.0 else folded
    return min(max(coordinate, 0.0), 1.0)


@njit(cache=True, nogil=True, error_model="numpy")
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
    # Weights in 1/65536. Red and blue travel in the two halves of one number, green in another.
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
def paint(
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

    A texture is read over the footprint of the pixel: the shorter axis of the footprint chooses
    the level, and up to `MAX_TAPS` reads run along the longer one.

    Args:
        hits: Triangle of every ray, -1 for none, int32 [rays].
        surface: As filled by `locate`.
        colors: See `Scene`; the next ones see `renderer.py` and `TextureSet`.
        rgb: Filled where a triangle is hit: sRGB codes 0 to 255, float32 [rays, 3].
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
            while size >= 1.7 and level < coarsest:
                size *= 0.5
                level += 1
            if level < coarsest:
                blend = max((size - 1.3) * 2.5, 0.0)
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
        face_material: See `Scene`; `material_flags` see `renderer.py`.
        nodes: Light around the surfaces as a flat list, with its `shape` (layers, rows, columns),
            `origin` and `cell_m`; see `LightGrid`.
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
                rgb[ray, channel] = np.uint8(colors[ray, channel] + 0.5)
            continue
        nx, ny, nz = surface[ray, NORMAL], surface[ray, NORMAL + 1], surface[ray, NORMAL + 2]
        # So far in front of the surface that no node behind it has a say.
        lift = abs(nx) + abs(ny) + abs(nz)
        x = (surface[ray, POINT] - ox) * per_m + nx * lift
        y = (surface[ray, POINT + 1] - oy) * per_m + ny * lift
        z = (surface[ray, POINT + 2] - oz) * per_m + nz * lift
        x, y, z = min(max(x, 0.0), limit_x), min(max(y, 0.0), limit_y), min(max(z, 0.0), limit_z)
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
            rgb[ray, channel] = tone[min(step, TONE_STEPS - 1)]
    return missing
