"""Rasterization: the nearest triangle in every pixel of an image (numba kernels).

Rasterization in homogeneous coordinates (Olano and Greer, "Triangle Scan Conversion using 2D
Homogeneous Coordinates", 1997): a ray ``d`` through a pixel meets the triangle ``a b c`` (seen from
the camera) where ``d.(b x c)``, ``d.(c x a)`` and ``d.(a x b)`` have the sign of ``a.(b x c)``, and
their sum over it is one over the depth. All are linear over the image, so that every row of pixels
gives one interval, and nothing needs to be clipped, not even what reaches behind the camera.
"""

import math

from numba import njit
from numba.extending import register_jitable

_IN_FRONT = 1e-3
"""Metres: nearer triangles get no bounds, since their projection may be anywhere."""
_SLACK = 1e-7
"""Pixels: neighbours share an edge, and no pixel may slip between them by rounding."""
_NEARER = 1.0 + 1e-9
"""Of coincident surfaces the first is shown, so that rounding does not make a pattern."""


@njit(cache=True, nogil=True, error_model="numpy")
def find_visible(boxes, camera, width, cx, cy, first_row, last_row, seen, distances):
    """Groups of triangles that may show in some rows of an image.

    Args:
        boxes: Lowest and highest corner of every group, scene frame, float32 [groups, 2, 3].
        camera: As for `ray_kernels.fill_rays`.
        width: Width of the image, pixels.
        cx: Column of the principal point, pixels.
        cy: Row of the principal point, pixels.
        first_row: First of the rows.
        last_row: One beyond the last row.
        seen: Output: numbers of the visible groups, int64 [groups].
        distances: Output: their least depth along the optical axis, float64 [groups].

    Returns:
        Number of visible groups.
    """
    # A group is outside if it lies behind the camera, or beyond a plane through the camera and a
    # side of the image.
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
def draw_triangles(
    corners, groups, group_size, camera, cx, cy, first_row, one_sided, shown, nearness
):
    """Draw groups of triangles into some rows of an image.

    Args:
        corners: Corners of all triangles, scene frame, float32 [triangles, 3, 3].
        groups: Numbers of the groups to draw; group k holds the triangles from ``k * group_size``
            on.
        group_size: Triangles of a group; the last may have fewer.
        camera: As for `ray_kernels.fill_rays`.
        cx: Column of the principal point, pixels.
        cy: Row of the principal point, pixels.
        first_row: Image row of the first row of `shown`.
        one_sided: Whether triangles are left out where their back is seen.
        shown: Number of the nearest triangle in every pixel, int32 [rows, columns].
        nearness: One over its depth along the optical axis, float64 [rows, columns].
    """
    square_x = camera[2, 0] ** 2 + camera[2, 1] ** 2 + camera[2, 2] ** 2
    square_y = camera[3, 0] ** 2 + camera[3, 1] ** 2 + camera[3, 2] ** 2
    shift_x, shift_y = 0.5 - cx, first_row + 0.5 - cy
    for number in range(groups.shape[0]):
        start = groups[number] * group_size
        for triangle in range(start, min(start + group_size, corners.shape[0])):
            a = _in_camera(corners, triangle, 0, camera, square_x, square_y)
            b = _in_camera(corners, triangle, 1, camera, square_x, square_y)
            c = _in_camera(corners, triangle, 2, camera, square_x, square_y)
            _draw_triangle(triangle, a, b, c, shift_x, shift_y, one_sided, shown, nearness)


@njit(inline="always")
def _in_camera(corners, triangle, corner, camera, square_x, square_y):
    """A corner in camera coordinates, with x and y in pixels per metre of z."""
    x = corners[triangle, corner, 0] - camera[0, 0]
    y = corners[triangle, corner, 1] - camera[0, 1]
    z = corners[triangle, corner, 2] - camera[0, 2]
    return (
        (x * camera[2, 0] + y * camera[2, 1] + z * camera[2, 2]) / square_x,
        (x * camera[3, 0] + y * camera[3, 1] + z * camera[3, 2]) / square_y,
        x * camera[1, 0] + y * camera[1, 1] + z * camera[1, 2],
    )


@register_jitable(error_model="numpy", no_cfunc_wrapper=True)
def _draw_triangle(triangle, a, b, c, shift_x, shift_y, one_sided, shown, nearness):
    """Draw one triangle where it is nearer than what is drawn already.

    Args:
        triangle: Number of the triangle.
        a: First corner, from `_in_camera`.
        b: Second corner.
        c: Third corner.
        shift_x: Offset of the ray through the centre of column 0, pixels.
        shift_y: Offset of the ray through the centre of row 0, pixels.
        one_sided: As for `draw_triangles`.
        shown: As for `draw_triangles`.
        nearness: As for `draw_triangles`.
    """
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = a, b, c
    left, right, top, bottom = 0, shown.shape[1] - 1, 0, shown.shape[0] - 1
    if min(az, bz, cz) > _IN_FRONT:
        x, y, z = ax / az, bx / bz, cx / cz
        left = max(left, math.ceil(min(x, y, z) - shift_x - _SLACK))
        right = min(right, math.floor(max(x, y, z) - shift_x + _SLACK))
        if left > right:
            return
        x, y, z = ay / az, by / bz, cy / cz
        top = max(top, math.ceil(min(x, y, z) - shift_y - _SLACK))
        bottom = min(bottom, math.floor(max(x, y, z) - shift_y + _SLACK))
        if top > bottom:
            return
    elif max(az, bz, cz) <= 0.0:
        return
    # The weights of the corners, over the depth: value at the first pixel and changes.
    ux, uy, uz = by * cz - bz * cy, bz * cx - bx * cz, bx * cy - by * cx
    vx, vy, vz = cy * az - cz * ay, cz * ax - cx * az, cx * ay - cy * ax
    wx, wy, wz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    volume = ax * ux + ay * uy + az * uz
    if volume == 0.0 or (one_sided and volume > 0.0):
        return
    scale = 1.0 / volume
    ux, uy, vx, vy, wx, wy = ux * scale, uy * scale, vx * scale, vy * scale, wx * scale, wy * scale
    uz = uz * scale + ux * shift_x + uy * shift_y
    vz = vz * scale + vx * shift_x + vy * shift_y
    wz = wz * scale + wx * shift_x + wy * shift_y
    change = ux + vx + wx
    for row in range(top, bottom + 1):
        # Where in this row no weight is negative.
        first, last = float(left), float(right)
        u, v, w = uz + row * uy, vz + row * vy, wz + row * wy
        for value, slope in ((u, ux), (v, vx), (w, wx)):
            if slope > 0.0:
                first = max(first, -value / slope - _SLACK)
            elif slope < 0.0:
                last = min(last, -value / slope + _SLACK)
            elif value < 0.0:
                last = -1.0
        if not first <= last:
            continue
        near = u + v + w
        for column in range(math.ceil(first), math.floor(last) + 1):
            value = near + column * change
            if value > nearness[row, column] * _NEARER:
                nearness[row, column] = value
                shown[row, column] = triangle
