"""What a depth image shows of a position, compiled.

``lens`` and ``pose`` are those of `hypernav.mapping.top_down.integrate_kernels`. Positions are in
the ``map`` frame, metres, and (u, v) pixels of the image.
"""

from numba.extending import register_jitable

from hypernav.core.geometry import depth as depth_rule

BELIEVED_RANGES = 3.0
"""Depth, as a multiple of the sensor's largest depth, from which it is not believed."""
BELIEVED_M = 65.5
"""Depth, metres, from which it is a code, no measurement: the largest of 16 bits is 65.535 m."""

is_measured = register_jitable(no_cfunc_wrapper=True)(depth_rule.is_measured)


@register_jitable(no_cfunc_wrapper=True)
def depth_at(depth, u, v):
    """Depth of the pixel that holds (u, v), metres; 0 outside the image."""
    if u < 0.0 or v < 0.0 or u >= depth.shape[1] or v >= depth.shape[0]:
        return 0.0
    return depth[int(v), int(u)]


@register_jitable(no_cfunc_wrapper=True)
def ends_behind(depth, lens, u, v, behind):
    """Whether the pixel that holds (u, v) measured something beyond `behind` metres of depth."""
    d = depth_at(depth, u, v)
    return is_measured(d, lens[4], lens[5]) and d > behind


@register_jitable(no_cfunc_wrapper=True)
def passes(depth, lens, u, v, behind):
    """Whether the ray of the pixel that holds (u, v) ends beyond `behind` metres of depth.

    A measurement beyond the sensor's range is too inexact to be drawn, but it is certain that its
    ray came so far. Otherwise a person who stood before a distant wall would never be cleared.
    """
    d = depth_at(depth, u, v)
    is_far = is_measured(d, lens[5], min(BELIEVED_RANGES * lens[5], BELIEVED_M))
    return (is_far or is_measured(d, lens[4], lens[5])) and d > behind


@register_jitable(no_cfunc_wrapper=True)
def sees_floor(depth, lens, pose, x, y, heights):
    """Whether a cell is seen free, at the lowest of the ``heights`` that the image shows.

    Far away that is just above the floor. Near the robot, where the floor lies below the image's
    lower edge, it is higher: else a robot with a high camera would never see the floor of the blind
    zone around it as free.

    Returns:
        2 if seen free down to the floor, 1 if as low as the image shows, 0 if not seen free.
    """
    for j in range(heights.shape[0]):
        h = heights[j]
        z = pose[8] * x + pose[9] * y + pose[10] * h + pose[11]
        if z <= 0.0:  # a camera that looks up has the floor before it behind its image plane
            continue
        if z >= lens[5]:
            return 0
        v = lens[1] * (pose[4] * x + pose[5] * y + pose[6] * h + pose[7]) / z + lens[3]
        if v < depth.shape[0]:
            u = lens[0] * (pose[0] * x + pose[1] * y + pose[2] * h + pose[3]) / z + lens[2]
            if not ends_behind(depth, lens, u, v, z):
                return 0
            return 2 if j == 0 else 1
    return 0


@register_jitable(no_cfunc_wrapper=True)
def sees_through(depth, lens, pose, x, y, h, sizes, margins):
    """Whether all rays around a voxel's middle end well behind it.

    The corners of the voxel's outline are tested as well as its middle: a thin object that fills
    only a part of the voxel still blocks it.
    """
    z = pose[8] * x + pose[9] * y + pose[10] * h + pose[11]
    if z <= sizes[0] or z >= lens[5]:
        return False
    behind = z + margins[0] + margins[1] * z
    u = lens[0] * (pose[0] * x + pose[1] * y + pose[2] * h + pose[3]) / z + lens[2]
    v = lens[1] * (pose[4] * x + pose[5] * y + pose[6] * h + pose[7]) / z + lens[3]
    if not passes(depth, lens, u, v, behind):
        return False
    du, dv = lens[0] * sizes[0] / 2 / z, lens[1] * sizes[1] / 2 / z
    for corner in range(4):
        u_corner = u + du if corner & 1 else u - du
        v_corner = v + dv if corner & 2 else v - dv
        if not passes(depth, lens, u_corner, v_corner, behind):
            return False
    return True


@register_jitable(no_cfunc_wrapper=True)
def in_sight(width, lens, pose, x, y, low, high):
    """Whether a part of a cell's column between two heights, metres, may lie in the image."""
    left, right = 0, 0
    for h in (low, high):
        z = pose[8] * x + pose[9] * y + pose[10] * h + pose[11]
        if z <= 0.0:
            continue
        u = lens[0] * (pose[0] * x + pose[1] * y + pose[2] * h + pose[3]) + lens[2] * z
        if u < 0.0:
            left += 1
        elif u >= width * z:
            right += 1
        elif z < lens[5]:
            return True
    return left == 1 and right == 1
