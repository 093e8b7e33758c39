"""The voxels' heights under one polygon (numba kernels), as ``getHeightData`` of Recast.

A patch is an array by column z and column x, with the column of its first entry; `UNSET` where no
height is known.
"""

import math

import numpy as np
from numba import njit

from hypernav.worlds.navmesh.recast.open_space_kernels import NOTHING

UNSET = 0xFFFF
_AROUND = np.array(
    [[0, 0], [-1, -1], [0, -1], [1, -1], [1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0]], dtype=np.int32
)
_FARTHEST = np.float32(np.finfo(np.float32).max)
_SHIFT = np.float32(0.01)


@njit(cache=True, nogil=True)
def height_patch(space, regions, region, vertices, corners):
    """Heights over a polygon's box: those of its region, extended to connected spans.

    Args:
        space: Open space, eroded.
        regions: Region of every span.
        region: Region of the polygon.
        vertices: Vertices (column x, height in voxels, column z).
        corners: Vertices of the polygon.

    Returns:
        The patch, and the column along x and along z of its first entry.
    """
    points = vertices[corners]
    x_low, x_end = max(points[:, 0].min() - 1, 0), min(points[:, 0].max() + 1, space.width)
    z_low, z_end = max(points[:, 2].min() - 1, 0), min(points[:, 2].max() + 1, space.depth)
    patch = np.full((max(z_end - z_low, 0), max(x_end - x_low, 0)), UNSET)
    queue = np.empty(patch.size + 1, dtype=np.int64)
    end = 0
    empty = True
    for z in range(z_low, z_end):
        for x in range(x_low, x_end):
            column = x + z * space.width
            for i in range(space.start[column], space.start[column + 1]):
                if regions[i] != region:
                    continue
                patch[z - z_low, x - x_low] = space.floor[i]
                empty = False
                if _is_at_border(space, regions, i):
                    queue[end] = i
                    end += 1
                break
    if empty:
        seed = _span_at_middle(space, points, patch, x_low, z_low)
        patch[:] = UNSET
        patch[space.z[seed] - z_low, space.x[seed] - x_low] = space.floor[seed]
        queue[0] = seed
        end = 1
    head = 0
    while head < end:
        i = queue[head]
        head += 1
        for direction in range(4):
            beside = space.neighbours[i, direction]
            if beside == NOTHING or not _is_in(patch, space, beside, x_low, z_low):
                continue
            z, x = space.z[beside] - z_low, space.x[beside] - x_low
            if patch[z, x] == UNSET:
                patch[z, x] = space.floor[beside]
                queue[end] = beside
                end += 1
    return patch, x_low, z_low


@njit(cache=True, nogil=True)
def height_at(patch, x_low, z_low, x, y, z, per_cell, cell_height, reach):
    """Height at a point, voxels; if unset, that of the nearest height among entries around it.

    Args:
        patch: The patch.
        x_low: Column along x of its first entry.
        z_low: Column along z of its first entry.
        x: Point, metres from the lowest corner, single precision.
        y: As x.
        z: As x.
        per_cell: Columns per metre.
        cell_height: Height of a voxel, metres.
        reach: Columns within which other entries are searched.
    """
    column = math.floor(x * per_cell + _SHIFT) - x_low
    row = math.floor(z * per_cell + _SHIFT) - z_low
    column = min(max(column, 0), patch.shape[1] - 1)
    row = min(max(row, 0), patch.shape[0] - 1)
    height = patch[row, column]
    for ring in range(1, reach + 1):
        if height != UNSET:
            return height
        nearest = _FARTHEST
        # Around the ring in the order of Recast, which decides ties.
        dx, dz = ring, 1 - ring
        step_x, step_z = 0, 1
        for _ in range(8 * ring):
            r, c = row + dz, column + dx
            if 0 <= r < patch.shape[0] and 0 <= c < patch.shape[1] and patch[r, c] != UNSET:
                gap = abs(np.float32(patch[r, c]) * cell_height - y)
                if gap < nearest:
                    height, nearest = patch[r, c], gap
            if (dx == ring and dz == ring) or (dx == -ring and abs(dz) == ring):
                step_x, step_z = -step_z, step_x
            dx, dz = dx + step_x, dz + step_z
    return height


@njit(cache=True, nogil=True)
def _is_at_border(space, regions, i):
    for direction in range(4):
        beside = space.neighbours[i, direction]
        if beside != NOTHING and regions[beside] != regions[i]:
            return True
    return False


@njit(cache=True, nogil=True)
def _is_in(patch, space, i, x_low, z_low):
    z, x = space.z[i] - z_low, space.x[i] - x_low
    return 0 <= z < patch.shape[0] and 0 <= x < patch.shape[1]


@njit(cache=True, nogil=True)
def _span_at_middle(space, points, patch, x_low, z_low):
    """The span at a polygon's middle, reached from one of its corners without leaving the patch."""
    seed = _span_at_corner(space, points, patch, x_low, z_low)
    middle_x, middle_z = points[:, 0].sum() // len(points), points[:, 2].sum() // len(points)
    stack = np.empty(patch.size + 4, dtype=np.int64)
    seen = np.zeros(patch.shape, dtype=np.bool_)
    directions = np.arange(4)
    stack[0] = seed
    depth = 1
    i = seed
    while depth > 0:
        depth -= 1
        i = stack[depth]
        x, z = space.x[i], space.z[i]
        if x == middle_x and z == middle_z:
            break
        straight = (1 if middle_z > z else 3) if x == middle_x else 2 if middle_x > x else 0
        # The last one pushed onto the stack is the next one popped.
        directions[straight], directions[3] = directions[3], directions[straight]
        for direction in directions:
            beside = space.neighbours[i, direction]
            if beside == NOTHING or not _is_in(patch, space, beside, x_low, z_low):
                continue
            if seen[space.z[beside] - z_low, space.x[beside] - x_low]:
                continue
            seen[space.z[beside] - z_low, space.x[beside] - x_low] = True
            stack[depth] = beside
            depth += 1
        directions[straight], directions[3] = directions[3], directions[straight]
    return i


@njit(cache=True, nogil=True)
def _span_at_corner(space, points, patch, x_low, z_low):
    """The span nearest in height to a corner of a polygon, at the corner or beside it."""
    nearest, gap = 0, UNSET
    for k in range(len(points)):
        for around in range(len(_AROUND)):
            x, z = points[k, 0] + _AROUND[around, 0], points[k, 2] + _AROUND[around, 1]
            if not (0 <= x - x_low < patch.shape[1] and 0 <= z - z_low < patch.shape[0]):
                continue
            column = x + z * space.width
            for i in range(space.start[column], space.start[column + 1]):
                if gap > 0 and abs(points[k, 1] - space.floor[i]) < gap:
                    nearest, gap = i, abs(points[k, 1] - space.floor[i])
    return nearest
