"""Drops, where a depth image shows that there is no floor, compiled.

A robot that does not climb stairs would fall there. Its camera sees no floor where a ray comes back
from below it: down the stairs, or through a hatch. A cell is a drop until `DROP_VIEWS` frames have
shown its floor. For a robot that climbs, such a cell is unknown: stairs may lead down there.

``lens``, ``pose`` and ``fall`` are those of `hypernav.mapping.top_down.integrate_kernels`.
"""

import numpy as np
from numba.extending import register_jitable

from hypernav.mapping.top_down.depth_kernels import depth_at, is_measured

DROP_VIEWS = 3
"""Number of frames that must show the floor of a cell before a drop is forgotten."""
_STEEP = 0.5
"""Rise per metre from which a surface is no ground."""


@register_jitable(no_cfunc_wrapper=True)
def height_at(depth, lens, pose, u, v):
    """Height above the floor of what a pixel shows, metres; infinite where it measured nothing."""
    d = depth_at(depth, u, v)
    if not is_measured(d, lens[4], lens[5]):
        return np.inf
    x, y = (u - lens[2]) / lens[0] * d - pose[3], (v - lens[3]) / lens[1] * d - pose[7]
    return pose[2] * x + pose[6] * y + pose[10] * (d - pose[11])


@register_jitable(no_cfunc_wrapper=True)
def is_below(depth, lens, pose, u, v, fall, share):
    """Whether a pixel shows a point a share of ``fall`` below the floor."""
    h = height_at(depth, lens, pose, u, v)
    if h >= 0.0:
        return False
    floor_depth = depth_at(depth, u, v) * fall[0] / (fall[0] - h)
    return h < -share * (fall[1] + fall[2] * floor_depth)


@register_jitable(no_cfunc_wrapper=True)
def is_lower_ground(depth, lens, pose, u, v, lowest):
    """Whether a pixel shows level ground below the floor, but not as far below as `lowest`."""
    upper = height_at(depth, lens, pose, u, v - 1.0)
    lower = height_at(depth, lens, pose, u, v + 1.0)
    farther = depth_at(depth, u, v - 1.0) - depth_at(depth, u, v + 1.0)
    return abs(upper - lower) < _STEEP * abs(farther) and max(upper, lower) > -lowest


@register_jitable(no_cfunc_wrapper=True)
def shows_below(depth, lens, pose, x, y, fall):
    """What the pixel of a point on the floor shows, or the lowest one in its direction.

    Returns:
        2 if it and those around it show what lies below the floor, 1 if it may, 0 if it does not.
    """
    z = pose[8] * x + pose[9] * y + pose[11]
    if z <= 0.0:
        return 0
    u = lens[0] * (pose[0] * x + pose[1] * y + pose[3]) / z + lens[2]
    v = lens[1] * (pose[4] * x + pose[5] * y + pose[7]) / z + lens[3]
    v = min(v, depth.shape[0] - 1.5)
    if not is_below(depth, lens, pose, u, v, fall, 0.5):
        return 0
    if fall[3] < np.inf and is_lower_ground(depth, lens, pose, u, v, fall[3]):
        return 0
    for i in range(-1, 2):  # single pixels err
        for j in range(-1, 2):
            if fall[3] < np.inf and not is_measured(
                depth_at(depth, u + j, v + i), lens[4], lens[5]
            ):
                continue  # a hole beside it says nothing
            if not is_below(depth, lens, pose, u + j, v + i, fall, 1.0):
                return 1
    return 2
