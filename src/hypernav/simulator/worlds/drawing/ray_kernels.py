"""Rays through pixels, surfaces that they hit, and pixels that need several rays (numba kernels).

`measure` and `locate` are the first of three passes from rays to colours; the others are
`fill_base_colors` and `light` of `shading_kernels`. Each pass loops over a flat list of rays and
takes plain arrays: a tuple of arrays would be copied for every call of an inner function. The
passes communicate through `surface`, one row of float32 per ray, whose columns are named here.
Neighbouring rays mostly hit the same triangle, so what holds for the whole triangle is computed
when the triangle changes.
"""

# The values of a triangle are set when it changes, so also at the first one.
# pyright: reportPossiblyUnboundVariable=false

import math

import numpy as np
from numba import njit
from numba.extending import register_jitable

NORMAL = 0  # 3 columns, towards the camera
POINT = 3  # 3 columns, scene frame
FACING = 6  # cosine between the normal and the direction to the camera
WEIGHT = 7  # 2 columns: of the triangle's second and third corner
UV = 9  # 2 columns
UV_RIGHT = 11  # 2 columns: change of uv to the next pixel on the right
UV_DOWN = 13  # 2 columns: to the next pixel below
SURFACE_COLUMNS = 15
_CONTRAST = 28
# A strong contrast needs less of a bend: depth hardly shows where ceilings meet walls.
_BEND_CONTRAST = 0.35


@njit(cache=True, nogil=True, error_model="numpy")
def fill_rays(camera, cx, cy, first_row, directions):
    """Rays through the centres of the pixels of some rows; 1 long along the optical axis.

    Args:
        camera: Camera as rows: position; optical axis; change of direction to the next pixel right;
            to the next pixel down; float64 [4, 3], scene frame.
        cx: Column of the principal point, pixels.
        cy: Row of the principal point, pixels.
        first_row: Image row of the first row of rays.
        directions: Output: directions, float32 [rows, columns, 3].
    """
    for row in range(directions.shape[0]):
        y = first_row + row + 0.5 - cy
        for column in range(directions.shape[1]):
            x = column + 0.5 - cx
            for axis in range(3):
                directions[row, column, axis] = (
                    camera[1, axis] + x * camera[2, axis] + y * camera[3, axis]
                )


@njit(cache=True, nogil=True, error_model="numpy")
def fill_rays_around(camera, cx, cy, width, pixels, offsets, origins, directions):
    """Several rays through each of some pixels, beside their centres.

    Args:
        camera: As for `fill_rays`.
        cx: Column of the principal point, pixels.
        cy: Row of the principal point, pixels.
        width: Width of the image, pixels.
        pixels: Numbers of the pixels, row by row, int64 [pixels].
        offsets: Offsets from the centre, ``(right, down)`` in pixels, float64 [offsets, 2].
        origins: Output: origins, float32 [pixels * offsets, 3].
        directions: Output: directions, float32 [pixels * offsets, 3].
    """
    ray = 0
    for pixel in pixels:
        for offset in range(offsets.shape[0]):
            x = pixel % width + 0.5 + offsets[offset, 0] - cx
            y = pixel // width + 0.5 + offsets[offset, 1] - cy
            for axis in range(3):
                origins[ray, axis] = camera[0, axis]
                directions[ray, axis] = camera[1, axis] + x * camera[2, axis] + y * camera[3, axis]
            ray += 1


@njit(inline="always")
def _triangle(vertices, faces, face, camera):
    """First corner of a triangle as seen from the camera, and the edges from it to the others."""
    i, j, k = faces[face, 0], faces[face, 1], faces[face, 2]
    ax, ay, az = (
        np.float64(vertices[i, 0]),
        np.float64(vertices[i, 1]),
        np.float64(vertices[i, 2]),
    )
    return (
        (ax - camera[0, 0], ay - camera[0, 1], az - camera[0, 2]),
        (vertices[j, 0] - ax, vertices[j, 1] - ay, vertices[j, 2] - az),
        (vertices[k, 0] - ax, vertices[k, 1] - ay, vertices[k, 2] - az),
    )


@njit(cache=True, nogil=True, error_model="numpy")
def measure(hits, directions, camera, vertices, faces, face_instance, depth, ids):
    """Depth and instance of the triangle that every ray hits.

    Args:
        hits: Triangle of every ray, -1 for none, int32 [rays].
        directions: Directions, scene frame, 1 long along the optical axis, float32 [rays, 3].
        camera: As for `fill_rays`.
        vertices: See `Scene`.
        faces: See `Scene`.
        face_instance: See `Scene`.
        depth: Output: depth along the optical axis, 0 where nothing is hit, float32 [rays].
        ids: Output: instances, -1 where nothing is hit, int32 [rays].
    """
    zx, zy, zz = camera[1, 0], camera[1, 1], camera[1, 2]
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
            corner, edge, other = _triangle(vertices, faces, face, camera)
            (ax, ay, az), (ex, ey, ez), (fx, fy, fz) = corner, edge, other
            nx, ny, nz = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
            plane = nx * ax + ny * ay + nz * az
            da = zx * ax + zy * ay + zz * az
            db = da + zx * ex + zy * ey + zz * ez
            dc = da + zx * fx + zy * fy + zz * fz
            nearest, farthest = min(da, db, dc), max(da, db, dc)
        dx, dy, dz = directions[ray, 0], directions[ray, 1], directions[ray, 2]
        distance = plane / (nx * dx + ny * dy + nz * dz)
        # A thin triangle's plane seen edge-on is ill defined, but depth is between its corners'.
        if not distance >= nearest:  # "not" catches NaN as well
            distance = nearest
        depth[ray] = min(distance, farthest)
        ids[ray] = instance


@njit(cache=True, nogil=True, error_model="numpy")
def locate(hits, directions, depth, camera, vertices, faces, normals, uv, surface):
    """First pass: points, normals and texture coordinates where rays hit triangles.

    Args:
        hits: Triangle of every ray, -1 for none, int32 [rays].
        directions: Directions, scene frame, 1 long along the optical axis, float32 [rays, 3].
        depth: Depth from `measure`, float32 [rays].
        camera: As for `fill_rays`.
        vertices: See `Scene`.
        faces: See `Scene`.
        normals: See `Scene`; shape [0, 0, 3] where there are none.
        uv: See `Scene`.
        surface: Output where a triangle is hit, float32 [rays, SURFACE_COLUMNS].
    """
    ox, oy, oz = camera[0, 0], camera[0, 1], camera[0, 2]
    rx, ry, rz = camera[2, 0], camera[2, 1], camera[2, 2]
    lx, ly, lz = camera[3, 0], camera[3, 1], camera[3, 2]
    last = -1
    for ray in range(hits.shape[0]):
        face = hits[ray]
        if face < 0:
            continue
        if face != last:  # what holds for the whole triangle; the next ray mostly hits it again
            last = face
            corner, edge, other = _triangle(vertices, faces, face, camera)
            (ax, ay, az), (ex, ey, ez), (fx, fy, fz) = corner, edge, other
            nx, ny, nz = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
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
        z = np.float64(depth[ray])
        px, py, pz = z * dx, z * dy, z * dz
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
        sx, sy, sz = z * (rx - slide * dx), z * (ry - slide * dy), z * (rz - slide * dz)
        surface[ray, UV_RIGHT] = sx * ux + sy * uy + sz * uz
        surface[ray, UV_RIGHT + 1] = sx * vx + sy * vy + sz * vz
        slide = down * along
        sx, sy, sz = z * (lx - slide * dx), z * (ly - slide * dy), z * (lz - slide * dz)
        surface[ray, UV_DOWN] = sx * ux + sy * uy + sz * uz
        surface[ray, UV_DOWN + 1] = sx * vx + sy * vy + sz * vz

        # The normal, of unit length, turned towards the camera.
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


@register_jitable(error_model="numpy", no_cfunc_wrapper=True)
def _bend(before, near, far, after):
    """Deviation of four depths in a row from a plane through the middle two; 0 is no depth.

    On a plane the inverse of depth changes evenly from pixel to pixel.
    """
    if near == 0.0 or far == 0.0:
        return 0.0 if near == far else 1.0
    step = 1.0 / far - 1.0 / near
    bend = 0.0
    if before > 0.0:
        bend = abs(step - (1.0 / near - 1.0 / before))
    if after > 0.0:
        bend = max(bend, abs(1.0 / after - 1.0 / far - step))
    return bend * near


@njit(cache=True, nogil=True, error_model="numpy")
def find_edges(rgb, ids, depth, first_row, last_row, pixels):
    """Pixels of some rows at which objects or faces meet with a visible contrast.

    Args:
        rgb: Colours, uint8 [height, width, 3].
        ids: Instances, int32 [height, width].
        depth: Depth in metres, 0 where nothing was hit, float32 [height, width].
        first_row: First row to search.
        last_row: One beyond the last row.
        pixels: Output: pixel numbers, row by row, int64 [rows * width].

    Returns:
        Number of edge pixels.
    """
    height, width = depth.shape
    marked = np.zeros((last_row - first_row, width), dtype=np.bool_)
    for row in range(max(first_row - 1, 0), last_row):
        for column in range(width):
            for down in range(2):  # the next pixel on the right, then the one below
                y, x = row + down, column + 1 - down
                if y >= height or x >= width or (down == 0 and row < first_row):
                    continue
                contrast = 0
                for channel in range(3):
                    here, there = np.int32(rgb[row, column, channel]), np.int32(rgb[y, x, channel])
                    contrast = max(contrast, abs(here - there))
                if contrast <= _CONTRAST:
                    continue
                if ids[row, column] == ids[y, x]:
                    y0, x0 = row - down, column - 1 + down
                    y3, x3 = y + down, x + 1 - down
                    before = depth[y0, x0] if y0 >= 0 and x0 >= 0 else np.float32(0.0)
                    after = depth[y3, x3] if y3 < height and x3 < width else np.float32(0.0)
                    bend = _bend(before, depth[row, column], depth[y, x], after)
                    if bend * contrast < _BEND_CONTRAST:
                        continue
                if row >= first_row:
                    marked[row - first_row, column] = True
                if y < last_row:
                    marked[y - first_row, x] = True
    count = 0
    for row in range(last_row - first_row):
        for column in range(width):
            if marked[row, column]:
                pixels[count] = (first_row + row) * width + column
                count += 1
    return count


@njit(cache=True, nogil=True, error_model="numpy")
def mix_samples(pixels, samples, rgb):
    """Replace the colour of pixels by the mean of itself and of further samples.

    Args:
        pixels: Pixel numbers, int64 [pixels].
        samples: Further colours, uint8 [pixels, samples, 3].
        rgb: Colours, changed in place, uint8 [height * width, 3].
    """
    count = samples.shape[1] + 1
    for number in range(pixels.shape[0]):
        for channel in range(3):
            total = np.int64(rgb[pixels[number], channel])
            for sample in range(samples.shape[1]):
                total += samples[number, sample, channel]
            rgb[pixels[number], channel] = (total + count // 2) // count
