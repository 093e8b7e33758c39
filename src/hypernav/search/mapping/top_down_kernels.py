"""Integration of one depth frame into the map, compiled.

A frame works inside a window of the map, the box around its field of view. First the points are
counted per voxel. Then every *cell of the window* is projected into the depth image, instead of
tracing every pixel's ray through the map: whether a ray passes the cell has the same answer, at a
hundredth of the cost and without gaps between rays.

A robot that does not climb stairs would fall where there is no floor. Its camera sees none where a
ray comes back from below it: down the stairs, or through a hatch. A cell is such a drop until
`DROP_VIEWS` frames have shown its floor. For a robot that climbs it is unknown: stairs may lead
down there.

The kernels take plain arrays and plain tuples, because numba's cache on disk breaks when a named
type in it is renamed:

- ``arrays``, the map, rows along y and columns along x: ``evidence`` uint8 (rows, columns, layers)
  of every voxel of the height band; ``raised`` uint32 bit mask of the layers that have evidence;
  ``seen`` uint8, 1 where the cell was seen to be free floor or the robot stood, 2 where it was seen
  to have no floor, if that makes no obstacle; ``bumps`` and
  ``drops`` uint8, clear views until the robot's bump there, or a drop, is forgotten: no cell has
  both; ``cells`` uint8, the outcome, values of `Cell`
- ``window``: row and column in the map, rows, columns
- ``lens``: fx, fy, cx, cy, pixels, then limits of the sensor's range, both exclusive, metres
- ``pose``: the upper three rows of the matrix from the ``map`` to the optical frame, flat
- ``sizes``: side of a cell, height of a voxel, bottom of the height band, metres
- ``weights``: fewest points of a hit, evidence of a hit, evidence of a pass, evidence from which a
  cell is occupied, largest evidence
- ``margins``: metres, and metres per metre, that a ray must end behind a voxel to have passed it
- ``fall``: height of the camera above the floor, then how far below it, in metres and in metres per
  metre of depth, a point shows that its ray has passed no floor, infinite if drops don't matter;
  then how far, in metres, ground may be below it and belong to it: infinite if drops are obstacles,
  else they stay unknown

Positions are in the ``map`` frame, metres, and (u, v) pixels of the image.
"""

import numpy as np
from numba import njit
from numba.extending import register_jitable

from hypernav.core.geometry import depth as depth_rule

BELIEVED_RANGES = 3.0
"""Depth, as a multiple of the sensor's largest depth, from which it is not believed."""
BELIEVED_M = 65.5
"""Depth, metres, from which it is a code, no measurement: the largest of 16 bits is 65.535 m."""

is_measured = register_jitable(no_cfunc_wrapper=True)(depth_rule.is_measured)

DROP_VIEWS = 3
"""Number of frames that must show the floor of a cell before a drop is forgotten."""
_STEEP = 0.5
"""Rise per metre from which a surface is no ground."""

UNKNOWN, FREE, OCCUPIED = 0, 1, 2
FLOOR, NO_FLOOR = 1, 2


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


@register_jitable(no_cfunc_wrapper=True)
def count_points(depth, nearest, farthest, start, across, down, columns, layers, counts, touched):
    """Count the points in every voxel of the window.

    Args:
        depth: float32 (height, width), metres; what is not measured is skipped.
        nearest: float32, lower limit of the sensor's range, exclusive, metres.
        farthest: float32, upper limit of the sensor's range, exclusive, metres.
        start: float32 (3,), the camera in voxels of the window, as (column, row, layer).
        across: float32 (width, 3), change per metre of depth for the pixel's column, in voxels.
        down: float32 (height, 3), change per metre of depth for the pixel's row, in voxels.
        columns: Number of columns of the window.
        layers: Number of layers of voxels in the height band.
        counts: uint16, flat (row, column, layer) of the window, zero on entry.
        touched: int32, receives the indices of the counts that are no longer zero.

    Returns:
        Number of touched voxels.
    """
    x0, y0, z0 = start[0], start[1], start[2]
    top = np.float32(layers)
    least_rise = across[:, 2].min()
    n = 0
    for v in range(depth.shape[0]):
        bx, by, bz = down[v, 0], down[v, 1], down[v, 2]
        rise = bz + least_rise
        if rise >= np.float32(0.0) and z0 + nearest * rise >= top:
            continue  # all rays of this row have left the height band before the nearest depth
        for u in range(depth.shape[1]):
            d = depth[v, u]
            if not is_measured(d, nearest, farthest):
                continue
            h = z0 + d * (bz + across[u, 2])
            if h < np.float32(0.0) or h >= top:
                continue
            column = int(x0 + d * (bx + across[u, 0]))
            row = int(y0 + d * (by + across[u, 1]))
            i = (row * columns + column) * layers + int(h)
            c = counts[i]
            if c == 0:
                touched[n] = i
                n += 1
            if c < 65535:
                counts[i] = c + 1
    return n


@register_jitable(no_cfunc_wrapper=True)
def add_hits(counts, touched, n, window, weights, arrays):
    """Add evidence to the voxels that enough of the counted points hit."""
    evidence, raised, _, _, _, cells = arrays
    fewest, hit, _, enough, most = weights
    row0, column0, _, columns = window
    layers = evidence.shape[2]
    for j in range(n):
        i = touched[j]
        if counts[i] < fewest:
            continue
        k = i % layers
        i //= layers
        row, column = row0 + i // columns, column0 + i % columns
        e = min(evidence[row, column, k] + hit, most)
        evidence[row, column, k] = e
        raised[row, column] |= np.uint32(1) << np.uint32(k)
        if e >= enough:
            cells[row, column] = OCCUPIED


@register_jitable(no_cfunc_wrapper=True)
def state_of(arrays, row, column, enough):
    """State of a cell, from all that is known about it."""
    evidence, _, seen, bumps, drops, _ = arrays
    if bumps[row, column] > 0 or drops[row, column] > 0:
        return OCCUPIED
    for k in range(evidence.shape[2]):
        if evidence[row, column, k] >= enough:
            return OCCUPIED
    return FREE if seen[row, column] == FLOOR else UNKNOWN


@register_jitable(no_cfunc_wrapper=True)
def sweep_window(depth, lens, pose, heights, window, sizes, weights, margins, fall, counts, arrays):
    """Free what the frame sees to be free, cell by cell of the window.

    A voxel that a ray passes loses evidence, unless it has a point in this very frame (``counts``
    of `count_points`). ``heights``, float64 (n,), metres, are those that `sees_floor` tests: just
    above the floor first, then up the height band and, for a camera above it, up to the camera.
    After the ``window`` come x and y of its corner, metres. The ``arrays`` are changed in place.
    """
    evidence, raised, seen, bumps, drops, cells = arrays
    row0, column0, rows, columns, x0, y0 = window
    layers = evidence.shape[2]
    top = max(sizes[2] + layers * sizes[1], heights[-1])
    for i in range(rows):
        y = y0 + (i + 0.5) * sizes[0]
        row = row0 + i
        for j in range(columns):
            x = x0 + (j + 0.5) * sizes[0]
            if not in_sight(depth.shape[1], lens, pose, x, y, 0.0, top):
                continue
            column = column0 + j
            changed = False
            floor = sees_floor(depth, lens, pose, x, y, heights)
            below = 0
            if floor > 0 and fall[1] < np.inf:
                below = shows_below(depth, lens, pose, x, y, fall)
            if below == 2 and (floor == 2 or seen[row, column] != FLOOR):
                if fall[3] == np.inf:
                    drops[row, column], bumps[row, column] = DROP_VIEWS, 0
                else:
                    seen[row, column] = NO_FLOOR
                changed = True
            elif floor == 2 or (floor == 1 and below == 0):
                changed = seen[row, column] != FLOOR
                seen[row, column] = FLOOR
                if floor == 2 and below == 0 and cells[row, column] == OCCUPIED:
                    for views in (bumps, drops):
                        if views[row, column] > 0:
                            views[row, column] -= 1
                            changed = True
            mask = raised[row, column]
            for k in range(layers if mask != 0 else 0):
                bit = np.uint32(1) << np.uint32(k)
                if mask & bit == 0 or counts[(i * columns + j) * layers + k] > 0:
                    continue
                h = sizes[2] + (k + 0.5) * sizes[1]
                if sees_through(depth, lens, pose, x, y, h, sizes, margins):
                    e = max(evidence[row, column, k] - weights[2], 0)
                    evidence[row, column, k] = e
                    if e == 0:
                        raised[row, column] &= ~bit
                    changed = True
            if changed:
                cells[row, column] = state_of(arrays, row, column, weights[3])


@register_jitable(no_cfunc_wrapper=True)
def free_footprint(robot, arrays):
    """Free the cells that the robot stands on, given continuous row, column, radius, in cells.

    With a radius of 0, none are freed.
    """
    evidence, raised, seen, bumps, drops, cells = arrays
    row, column, radius = robot
    if radius <= 0.0:
        return
    reach = int(radius) + 1
    for i in range(max(int(row) - reach, 0), min(int(row) + reach + 1, cells.shape[0])):
        for j in range(max(int(column) - reach, 0), min(int(column) + reach + 1, cells.shape[1])):
            if (i + 0.5 - row) ** 2 + (j + 0.5 - column) ** 2 <= radius**2:
                for k in range(evidence.shape[2]):
                    evidence[i, j, k] = 0
                raised[i, j] = 0
                bumps[i, j] = drops[i, j] = 0
                seen[i, j] = FLOOR
                cells[i, j] = FREE


@njit(cache=True, nogil=True)
def integrate_frame(
    depth,
    rays,
    lens,
    pose,
    heights,
    window,
    corner,
    robot,
    sizes,
    weights,
    margins,
    fall,
    counts,
    touched,
    arrays,
):
    """Integrate one frame: count points, add hits, free what is seen through, free the footprint.

    Beside what is described above: ``rays`` are ``start``, ``across`` and ``down`` of
    `count_points`, ``heights`` those of `sweep_window`, ``robot`` that of `free_footprint`. The
    ``corner`` is the window's lower left one, ``(x, y)``, metres. ``counts``, zero on entry and on
    return, and ``touched`` are scratch memory of `count_points`.
    """
    start, across, down = rays
    nearest, farthest = np.float32(lens[4]), np.float32(lens[5])
    layers = arrays[0].shape[2]
    n = count_points(
        depth, nearest, farthest, start, across, down, window[3], layers, counts, touched
    )
    add_hits(counts, touched, n, window, weights, arrays)
    sweep_window(
        depth, lens, pose, heights, window + corner, sizes, weights, margins, fall, counts, arrays
    )
    for j in range(n):
        counts[touched[j]] = 0
    free_footprint(robot, arrays)
