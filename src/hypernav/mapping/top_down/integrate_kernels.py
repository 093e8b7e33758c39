"""Integration of one depth frame into the map, compiled.

A frame works inside a window of the map, the box around its field of view. First the points are
counted per voxel. Then every *cell of the window* is projected into the depth image, instead of
tracing every pixel's ray through the map: whether a ray passes the cell has the same answer, at a
hundredth of the cost and without gaps between rays.

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
"""

import numpy as np
from numba import njit
from numba.extending import register_jitable

from hypernav.mapping.top_down.depth_kernels import in_sight, is_measured, sees_floor, sees_through
from hypernav.mapping.top_down.drop_kernels import DROP_VIEWS, shows_below

UNKNOWN, FREE, OCCUPIED = 0, 1, 2
FLOOR, NO_FLOOR = 1, 2


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
