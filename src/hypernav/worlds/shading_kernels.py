"""What a ray sees at the triangle that it hits: depth, texture, light. Compiled.

All functions of the shading live in this one module because numba's cache on disk notices changes
only in the file of the function that is called.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

MAX_TAPS = 4
TONE_STEPS = 4096
FLAG_UNLIT = 1
FLAG_CUTOUT = 2
NODE_KNOWN = 2
NODE_WANTED = 1


class Surfaces(NamedTuple):
    """The triangles and their looks; see `Scene` and `TextureSet`."""

    vertices: np.ndarray  # float32 [vertices, 3]
    faces: np.ndarray  # int32 [faces, 3]
    uv: np.ndarray  # float32 [faces, 3, 2]
    colors: np.ndarray  # uint8 [faces, 3, 3]
    normals: np.ndarray  # float32 [faces or 0, 3, 3]
    face_material: np.ndarray  # int32 [faces]
    face_instance: np.ndarray  # int32 [faces]
    material_color: np.ndarray  # float32 [materials, 3]
    material_flags: np.ndarray  # uint8 [materials]
    material_wrap: np.ndarray  # uint8 [materials, 2]
    material_texture: np.ndarray  # int32 [materials]
    texels: np.ndarray  # uint32 [texels]
    levels: np.ndarray  # int64 [textures, levels, 3]
    level_count: np.ndarray  # int32 [textures]


class Light(NamedTuple):
    """Baked light around the surfaces, the headlight and the tone curve; see `light.py`."""

    nodes: np.ndarray  # uint8 [z, y, x, 8]: light from +x -x +y -y +z -z, unused, state
    origin: np.ndarray  # float64 [3]
    cell_m: float
    ambient: float
    headlight: float
    tone: np.ndarray  # uint8 [TONE_STEPS], indexed by the square root of light


class View(NamedTuple):
    """A camera at a place: column i of `rotation` is the camera's axis i in the scene."""

    rotation: np.ndarray  # float64 [3, 3]
    position: np.ndarray  # float64 [3]
    fx: float
    fy: float
    cx: float
    cy: float


@njit(cache=True, nogil=True, error_model="numpy")
def fill_rays(view, u0, v0, origins, directions):
    """Rays through the pixels of rows that start at pixel coordinates (u0, v0); z is 1 in front."""
    height, width = directions.shape[:2]
    r = view.rotation
    for row in range(height):
        y = (v0 + row - view.cy) / view.fy
        for column in range(width):
            x = (u0 + column - view.cx) / view.fx
            for axis in range(3):
                origins[row, column, axis] = view.position[axis]
                directions[row, column, axis] = r[axis, 0] * x + r[axis, 1] * y + r[axis, 2]


@njit(cache=True, nogil=True, error_model="numpy")
def _wrapped(coordinate, mode):
    """A texture coordinate brought into [0, 1]."""
    if mode == 0:
        return coordinate - math.floor(coordinate)
    if mode == 1:
        folded = coordinate - 2.0 * math.floor(coordinate * 0.5)
        return 2.0 - folded if folded > 1.0 else folded
    return min(max(coordinate, 0.0), 1.0)


@njit(cache=True, nogil=True, error_model="numpy")
def _neighbours(coordinate, size, mode):
    """The two texels around a coordinate in [0, 1] and the weight of the second."""
    place = coordinate * size - 0.5
    low = math.floor(place)
    weight = place - low
    high = low + 1
    if low < 0:
        low = size - 1 if mode == 0 else 0
    if high >= size:
        high = 0 if mode == 0 else size - 1
    return low, high, weight


@njit(cache=True, nogil=True, error_model="numpy")
def _bilinear(s, texture, level, u, v, wrap_u, wrap_v):
    """Colour of a texture at one level, sRGB codes (0 to 255); v upwards."""
    first, width, height = s.levels[texture, level]
    x0, x1, fx = _neighbours(_wrapped(u, wrap_u), width, wrap_u)
    y0, y1, fy = _neighbours(1.0 - _wrapped(v, wrap_v), height, wrap_v)
    a = np.int64(s.texels[first + y0 * width + x0])
    b = np.int64(s.texels[first + y0 * width + x1])
    c = np.int64(s.texels[first + y1 * width + x0])
    d = np.int64(s.texels[first + y1 * width + x1])
    wa = (1.0 - fx) * (1.0 - fy)
    wb = fx * (1.0 - fy)
    wc = (1.0 - fx) * fy
    wd = fx * fy
    red = wa * (a & 255) + wb * (b & 255) + wc * (c & 255) + wd * (d & 255)
    a, b, c, d = a >> 8, b >> 8, c >> 8, d >> 8
    green = wa * (a & 255) + wb * (b & 255) + wc * (c & 255) + wd * (d & 255)
    a, b, c, d = a >> 8, b >> 8, c >> 8, d >> 8
    blue = wa * (a & 255) + wb * (b & 255) + wc * (c & 255) + wd * (d & 255)
    return red, green, blue


@njit(cache=True, nogil=True, error_model="numpy")
def _filtered(s, texture, u, v, ux, vx, uy, vy, wrap_u, wrap_v):
    """Colour of a texture over the footprint of a pixel.

    (ux, vx) and (uy, vy) are the steps in texture coordinates to the next pixel right and down.
    The shorter axis of the footprint chooses the level; up to MAX_TAPS reads run along the longer.
    """
    width, height = s.levels[texture, 0, 1], s.levels[texture, 0, 2]
    across = math.hypot(ux * width, vx * height)
    down = math.hypot(uy * width, vy * height)
    if across < down:
        ux, vx = uy, vy
    long, short = max(across, down), max(min(across, down), 1e-9)
    if long <= 1.0:
        return _bilinear(s, texture, 0, u, v, wrap_u, wrap_v)
    taps = min(math.ceil(long / short - 0.25), MAX_TAPS)
    finest = math.log2(max(long / taps, short, 1.0))
    last = s.level_count[texture] - 1
    level = min(int(finest), last)
    blend = finest - level if level < last else 0.0
    red, green, blue = 0.0, 0.0, 0.0
    for tap in range(taps):
        at = (tap + 0.5) / taps - 0.5
        tu, tv = u + ux * at, v + vx * at
        r, g, b = _bilinear(s, texture, level, tu, tv, wrap_u, wrap_v)
        if blend > 0.0:
            r1, g1, b1 = _bilinear(s, texture, level + 1, tu, tv, wrap_u, wrap_v)
            r, g, b = r + blend * (r1 - r), g + blend * (g1 - g), b + blend * (b1 - b)
        red, green, blue = red + r, green + g, blue + b
    return red / taps, green / taps, blue / taps


@njit(cache=True, nogil=True, error_model="numpy")
def _ambient(light, px, py, pz, nx, ny, nz):
    """Light that reaches a surface, 0 to 1, and whether any of it had to be guessed."""
    # In front of the surface far enough that no node behind it has a say.
    lift = abs(nx) + abs(ny) + abs(nz)
    x = (px - light.origin[0]) / light.cell_m + nx * lift
    y = (py - light.origin[1]) / light.cell_m + ny * lift
    z = (pz - light.origin[2]) / light.cell_m + nz * lift
    nodes = light.nodes
    x = min(max(x, 0.0), nodes.shape[2] - 1.001)
    y = min(max(y, 0.0), nodes.shape[1] - 1.001)
    z = min(max(z, 0.0), nodes.shape[0] - 1.001)
    ix, iy, iz = int(x), int(y), int(z)
    fx, fy, fz = x - ix, y - iy, z - iz
    side_x = 0 if nx > 0.0 else 1
    side_y = 2 if ny > 0.0 else 3
    side_z = 4 if nz > 0.0 else 5
    wx, wy, wz = nx * nx, ny * ny, nz * nz
    total, missing = 0.0, False
    for corner in range(8):
        cx, cy, cz = corner & 1, (corner >> 1) & 1, corner >> 2
        node = nodes[iz + cz, iy + cy, ix + cx]
        if node[7] != NODE_KNOWN:
            node[7] = NODE_WANTED
            missing = True
        weight = (fx if cx else 1.0 - fx) * (fy if cy else 1.0 - fy) * (fz if cz else 1.0 - fz)
        total += weight * (wx * node[side_x] + wy * node[side_y] + wz * node[side_z])
    return total / 255.0, missing


@njit(cache=True, nogil=True, error_model="numpy")
def _corner_blend(values, b0, b1, b2, axis):
    return b0 * values[0, axis] + b1 * values[1, axis] + b2 * values[2, axis]


@njit(cache=True, nogil=True, error_model="numpy")
def _linear(code):
    """Light of an sRGB value (both 0 to 1); a polynomial within 0.002 of the standard's curve."""
    return code * (code * (code * 0.305306011 + 0.682171111) + 0.012522878)


@njit(cache=True, nogil=True, error_model="numpy")
def _tone(light, value):
    step = int(math.sqrt(max(value, 0.0)) * (TONE_STEPS - 1) + 0.5)
    return light.tone[min(step, TONE_STEPS - 1)]


@njit(cache=True, nogil=True, error_model="numpy")
def _see(s, light, view, face, x, y, need_color):
    """What the ray through camera coordinates (x, y, 1) sees on a triangle that it hits.

    Returns depth, red, green, blue, and whether light was missing.
    """
    r, o = view.rotation, view.position
    dx = r[0, 0] * x + r[0, 1] * y + r[0, 2]
    dy = r[1, 0] * x + r[1, 1] * y + r[1, 2]
    dz = r[2, 0] * x + r[2, 1] * y + r[2, 2]
    i0, i1, i2 = s.faces[face, 0], s.faces[face, 1], s.faces[face, 2]
    ax, ay, az = s.vertices[i0, 0] - o[0], s.vertices[i0, 1] - o[1], s.vertices[i0, 2] - o[2]
    bx, by, bz = s.vertices[i1, 0] - o[0], s.vertices[i1, 1] - o[1], s.vertices[i1, 2] - o[2]
    cx, cy, cz = s.vertices[i2, 0] - o[0], s.vertices[i2, 1] - o[1], s.vertices[i2, 2] - o[2]
    ex, ey, ez = bx - ax, by - ay, bz - az
    fx, fy, fz = cx - ax, cy - ay, cz - az
    nx, ny, nz = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
    towards = nx * dx + ny * dy + nz * dz
    depth = (nx * ax + ny * ay + nz * az) / towards
    # Of a needle seen edge-on the plane is ill defined, but the depth lies between its corners'.
    da = r[0, 2] * ax + r[1, 2] * ay + r[2, 2] * az
    db = r[0, 2] * bx + r[1, 2] * by + r[2, 2] * bz
    dc = r[0, 2] * cx + r[1, 2] * cy + r[2, 2] * cz
    nearest, farthest = min(da, db, dc), max(da, db, dc)
    if not depth >= nearest:  # not a number as well
        depth = nearest
    if depth > farthest:
        depth = farthest
    if not need_color:
        return depth, np.uint8(0), np.uint8(0), np.uint8(0), False

    # Barycentric coordinates are linear in space: their gradients give value and change alike.
    square = nx * nx + ny * ny + nz * nz
    gx, gy, gz = (
        (fy * nz - fz * ny) / square,
        (fz * nx - fx * nz) / square,
        (fx * ny - fy * nx) / square,
    )
    hx, hy, hz = (
        (ny * ez - nz * ey) / square,
        (nz * ex - nx * ez) / square,
        (nx * ey - ny * ex) / square,
    )
    px, py, pz = depth * dx, depth * dy, depth * dz
    b1 = (px - ax) * gx + (py - ay) * gy + (pz - az) * gz
    b2 = (px - ax) * hx + (py - ay) * hy + (pz - az) * hz
    b1 = min(max(b1, 0.0), 1.0) if b1 == b1 else 0.0
    b2 = min(max(b2, 0.0), 1.0 - b1) if b2 == b2 else 0.0
    b0 = 1.0 - b1 - b2

    material = s.face_material[face]
    red = s.material_color[material, 0] * _corner_blend(s.colors[face], b0, b1, b2, 0)
    green = s.material_color[material, 1] * _corner_blend(s.colors[face], b0, b1, b2, 1)
    blue = s.material_color[material, 2] * _corner_blend(s.colors[face], b0, b1, b2, 2)
    texture = s.material_texture[material]
    if texture >= 0:
        uv = s.uv[face]
        eu, ev = uv[1, 0] - uv[0, 0], uv[1, 1] - uv[0, 1]
        fu, fv = uv[2, 0] - uv[0, 0], uv[2, 1] - uv[0, 1]
        # How far the hit point moves on the plane for one pixel right and one down.
        step = depth / view.fx
        slide = (nx * r[0, 0] + ny * r[1, 0] + nz * r[2, 0]) / towards
        qx, qy, qz = r[0, 0] - slide * dx, r[1, 0] - slide * dy, r[2, 0] - slide * dz
        s1, s2 = step * (qx * gx + qy * gy + qz * gz), step * (qx * hx + qy * hy + qz * hz)
        ux, vx = s1 * eu + s2 * fu, s1 * ev + s2 * fv
        step = depth / view.fy
        slide = (nx * r[0, 1] + ny * r[1, 1] + nz * r[2, 1]) / towards
        qx, qy, qz = r[0, 1] - slide * dx, r[1, 1] - slide * dy, r[2, 1] - slide * dz
        s1, s2 = step * (qx * gx + qy * gy + qz * gz), step * (qx * hx + qy * hy + qz * hz)
        uy, vy = s1 * eu + s2 * fu, s1 * ev + s2 * fv
        u, v = uv[0, 0] + b1 * eu + b2 * fu, uv[0, 1] + b1 * ev + b2 * fv
        wrap = s.material_wrap[material]
        tr, tg, tb = _filtered(s, texture, u, v, ux, vx, uy, vy, wrap[0], wrap[1])
        red, green, blue = red * tr / 255.0, green * tg / 255.0, blue * tb / 255.0
    if s.material_flags[material] & FLAG_UNLIT:
        return depth, np.uint8(red + 0.5), np.uint8(green + 0.5), np.uint8(blue + 0.5), False

    # The normal, turned to the side that is seen.
    size = -math.sqrt(square) if towards > 0.0 else math.sqrt(square)
    mx, my, mz = nx / size, ny / size, nz / size
    if s.normals.shape[0] > 0:
        kx = _corner_blend(s.normals[face], b0, b1, b2, 0)
        ky = _corner_blend(s.normals[face], b0, b1, b2, 1)
        kz = _corner_blend(s.normals[face], b0, b1, b2, 2)
        length = math.sqrt(kx * kx + ky * ky + kz * kz)
        if length > 1e-6:
            if kx * mx + ky * my + kz * mz < 0.0:
                length = -length
            mx, my, mz = kx / length, ky / length, kz / length
    shine, missing = _ambient(light, px + o[0], py + o[1], pz + o[2], mx, my, mz)
    facing = -(mx * dx + my * dy + mz * dz) / math.sqrt(dx * dx + dy * dy + dz * dz)
    shine = light.ambient * shine + light.headlight * max(facing, 0.0)
    return (
        depth,
        _tone(light, shine * _linear(red / 255.0)),
        _tone(light, shine * _linear(green / 255.0)),
        _tone(light, shine * _linear(blue / 255.0)),
        missing,
    )


@njit(cache=True, nogil=True, error_model="numpy")
def shade_rows(s, light, view, row0, faces, rgb, depth, ids):
    """Fill rows of the three images from the faces hit; pixels without a hit keep what they have.

    Returns whether light was missing: bake the wanted nodes and shade the rows again.
    """
    any_missing = False
    for row in range(faces.shape[0]):
        y = (row0 + row + 0.5 - view.cy) / view.fy
        for column in range(faces.shape[1]):
            face = faces[row, column]
            if face < 0:
                continue
            x = (column + 0.5 - view.cx) / view.fx
            d, red, green, blue, missing = _see(s, light, view, face, x, y, True)
            depth[row, column] = d
            ids[row, column] = s.face_instance[face]
            rgb[row, column, 0] = red
            rgb[row, column, 1] = green
            rgb[row, column, 2] = blue
            any_missing |= missing
    return any_missing
