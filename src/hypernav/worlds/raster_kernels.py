"""Which triangle every pixel of a picture shows first. Compiled.

Rasterization in homogeneous coordinates (Olano and Greer, "Triangle Scan Conversion using 2D
Homogeneous Coordinates", 1997): a ray ``d`` through a pixel meets the triangle ``a b c`` (seen from
the camera) where ``d.(b x c)``, ``d.(c x a)`` and ``d.(a x b)`` have the sign of ``a.(b x c)``, and
their sum over it is one over the way. All are linear over the picture, so that every row of pixels
gives one interval, and nothing needs to be clipped, not even what reaches behind the camera.
"""

import math

from numba import njit

_IN_FRONT = 1e-3
"""Metres: triangles that reach nearer get no bounds, since they project to anywhere."""
_SLACK = 1e-7
"""Pixels: neighbours share an edge, and no pixel may slip between them by rounding."""
_NEARER = 1.0 + 1e-9
"""Of surfaces in the same place the first is shown: rounding must not make a pattern of them."""


@njit(cache=True, nogil=True, error_model="numpy")
def find_visible(boxes, camera, width, cx, cy, first_row, last_row, seen, distances):
    """Groups of triangles that may show in some rows of a picture.

    Args:
        boxes: Lowest and highest corner of every group, scene frame, float32 [groups, 2, 3].
        camera: As for `geometry_kernels.fill_rays`.
        width: Of the picture.
        cx: Column of the principal point, pixels.
        cy: Row of the principal point, pixels.
        first_row: Of those rows.
        last_row: Not included.
        seen: Filled from the front with numbers of groups, int64 [groups].
        distances: Filled with their least way along the optical axis, float64 [groups].

    Returns:
        How many there are.
    """
    # A group is outside if it lies behind the camera, or beyond a plane through the camera and a
    # side of the picture.
    square_x = camera[2, 0] ** 2 + camera[2, 1] ** 2 + camera[2, 2] ** 2
    square_y = camera[3, 0] ** 2 + camera[3, 1] ** 2 + camera[3, 2] ** 2
    count = 0
    for group in range(boxes.shape[0]):
        outside = False
        nearest = 0.0
        for plane in range(5):
            reach = 0.0
            for axis in range(3):
                right, down = camera[2, axis] / square_x, camera[3, axis] / square_y
                if plane == 0:
                    normal = camera[1, axis]
                elif plane == 1:
                    normal = right + cx * camera[1, axis]
                elif plane == 2:
                    normal = (width - cx) * camera[1, axis] - right
                elif plane == 3:
                    normal = down - (first_row - cy) * camera[1, axis]
                else:
                    normal = (last_row - cy) * camera[1, axis] - down
                low = boxes[group, 0, axis] - camera[0, axis]
                high = boxes[group, 1, axis] - camera[0, axis]
                reach += max(normal * low, normal * high)
                if plane == 0:
                    nearest += min(normal * low, normal * high)
            if reach < 0.0:
                outside = True
                break
        if not outside:
            seen[count], distances[count] = group, nearest
            count += 1
    return count


@njit(cache=True, nogil=True, error_model="numpy")
def draw_triangles(corners, groups, group_size, camera, cx, cy, first_row, shown, nearness):
    """Draw groups of triangles into some rows of a picture.

    Args:
        corners: Of all triangles, scene frame, float32 [triangles, 3, 3].
        groups: Numbers of those to draw; group k holds the triangles from ``k * group_size`` on.
        group_size: Triangles of a group; the last may have fewer.
        camera: As for `geometry_kernels.fill_rays`.
        cx: Column of the principal point, pixels.
        cy: Row of the principal point, pixels.
        first_row: Of the picture, that the first row of `shown` belongs to.
        shown: Number of the nearest triangle in every pixel, int32 [rows, columns].
        nearness: One over its way along the optical axis, float64 [rows, columns].
    """
    rows, columns = shown.shape
    ox, oy, oz = camera[0, 0], camera[0, 1], camera[0, 2]
    zx, zy, zz = camera[1, 0], camera[1, 1], camera[1, 2]
    rx, ry, rz = camera[2, 0], camera[2, 1], camera[2, 2]
    lx, ly, lz = camera[3, 0], camera[3, 1], camera[3, 2]
    square_r = rx * rx + ry * ry + rz * rz
    square_l = lx * lx + ly * ly + lz * lz
    shift_x, shift_y = 0.5 - cx, first_row + 0.5 - cy
    for number in range(groups.shape[0]):
        start = groups[number] * group_size
        for triangle in range(start, min(start + group_size, corners.shape[0])):
            sx, sy, sz = (
                corners[triangle, 0, 0] - ox,
                corners[triangle, 0, 1] - oy,
                corners[triangle, 0, 2] - oz,
            )
            # Camera coordinates, with x and y in pixels per metre of z.
            az = sx * zx + sy * zy + sz * zz
            ax = (sx * rx + sy * ry + sz * rz) / square_r
            ay = (sx * lx + sy * ly + sz * lz) / square_l
            sx, sy, sz = (
                corners[triangle, 1, 0] - ox,
                corners[triangle, 1, 1] - oy,
                corners[triangle, 1, 2] - oz,
            )
            bz = sx * zx + sy * zy + sz * zz
            bx = (sx * rx + sy * ry + sz * rz) / square_r
            by = (sx * lx + sy * ly + sz * lz) / square_l
            sx, sy, sz = (
                corners[triangle, 2, 0] - ox,
                corners[triangle, 2, 1] - oy,
                corners[triangle, 2, 2] - oz,
            )
            dz = sx * zx + sy * zy + sz * zz
            dx = (sx * rx + sy * ry + sz * rz) / square_r
            dy = (sx * lx + sy * ly + sz * lz) / square_l

            left, right, top, bottom = 0, columns - 1, 0, rows - 1
            nearest = min(az, bz, dz)
            if nearest > _IN_FRONT:
                a, b, c = ax / az, bx / bz, dx / dz
                left = max(left, math.ceil(min(a, b, c) - shift_x - _SLACK))
                right = min(right, math.floor(max(a, b, c) - shift_x + _SLACK))
                if left > right:
                    continue
                a, b, c = ay / az, by / bz, dy / dz
                top = max(top, math.ceil(min(a, b, c) - shift_y - _SLACK))
                bottom = min(bottom, math.floor(max(a, b, c) - shift_y + _SLACK))
                if top > bottom:
                    continue
            elif max(az, bz, dz) <= 0.0:
                continue
            # The weights of the corners, over the way: value at the first pixel and changes.
            ux, uy, uz = by * dz - bz * dy, bz * dx - bx * dz, bx * dy - by * dx
            vx, vy, vz = dy * az - dz * ay, dz * ax - dx * az, dx * ay - dy * ax
            wx, wy, wz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
            volume = ax * ux + ay * uy + az * uz
            if volume == 0.0:
                continue
            scale = 1.0 / volume
            ux, uy, vx, vy, wx, wy = (
                ux * scale, uy * scale, vx * scale, vy * scale, wx * scale, wy * scale
            )  # fmt: skip
            uz = uz * scale + ux * shift_x + uy * shift_y
            vz = vz * scale + vx * shift_x + vy * shift_y
            wz = wz * scale + wx * shift_x + wy * shift_y
            change = ux + vx + wx
            for row in range(top, bottom + 1):
                first, last = float(left), float(right)
                u0, v0, w0 = uz + row * uy, vz + row * vy, wz + row * wy
                for value, slope in ((u0, ux), (v0, vx), (w0, wx)):
                    if slope > 0.0:
                        first = max(first, -value / slope - _SLACK)
                    elif slope < 0.0:
                        last = min(last, -value / slope + _SLACK)
                    elif value < 0.0:
                        last = -1.0
                if not first <= last:
                    continue
                begin, end = math.ceil(first), math.floor(last)
                near = u0 + v0 + w0
                for column in range(begin, end + 1):
                    value = near + column * change
                    if value > nearness[row, column] * _NEARER:
                        nearness[row, column] = value
                        shown[row, column] = triangle
