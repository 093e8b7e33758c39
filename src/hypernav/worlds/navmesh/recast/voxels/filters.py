"""Solid spans that a robot can't stand on, as ``RecastFilter.cpp``."""

import numpy as np
from jaxtyping import Int32, Int64

from hypernav.worlds.navmesh.recast.voxels.rasterization import Solid

OPEN = 0xFFFF
"""Ceiling where there is nothing above a span."""
STEPS = ((-1, 0), (0, 1), (1, 0), (0, -1))
"""Columns along x and z to the neighbour in each direction."""


def columns_of(start: Int64[np.ndarray, " starts"]) -> Int64[np.ndarray, " s"]:
    """The column of every span."""
    return np.repeat(np.arange(len(start) - 1), np.diff(start))


def ceilings(solid: Solid) -> Int32[np.ndarray, " s"]:
    """Lowest voxel above the open space over every span."""
    above = np.append(solid.low[1:], np.int32(OPEN))
    above[solid.start[1:][np.diff(solid.start) > 0] - 1] = OPEN
    return above


def keep_low_obstacles(solid: Solid, climb: int) -> None:
    """Let the robot stand on what lies on a walkable span and is no higher than it climbs."""
    column = columns_of(solid.start)
    on_walkable = solid.walkable[:-1] & (column[1:] == column[:-1])
    low = np.flatnonzero(on_walkable & (np.diff(solid.high) <= climb)) + 1
    # One obstacle on another doesn't count: what is written now was not looked at.
    solid.walkable[low] = True


def drop_low_ceilings(solid: Solid, height: int) -> None:
    """Take away spans over which there is less room than the robot is high."""
    solid.walkable[ceilings(solid) - solid.high < height] = False


def drop_ledges(solid: Solid, width: int, height: int, climb: int) -> None:
    """Take away spans beside a drop, or on a slope, that is more than the robot climbs."""
    depth = (len(solid.start) - 1) // width
    ceiling = ceilings(solid)
    own = np.flatnonzero(solid.walkable)
    z, x = np.divmod(columns_of(solid.start)[own], width)
    floor, roof = solid.high[own], ceiling[own]
    drop = np.full(len(own), OPEN)
    lowest, highest = floor.copy(), floor.copy()
    for step_x, step_z in STEPS:
        nx, nz = x + step_x, z + step_z
        inside = (nx >= 0) & (nz >= 0) & (nx < width) & (nz < depth)
        column = np.where(inside, nx + nz * width, 0)
        begin, end = solid.start[column], np.where(inside, solid.start[column + 1], 0)
        # From below everything to the first span; beside the voxels there is nothing at all.
        top = np.full(len(own), OPEN)
        top[begin < end] = solid.low[begin[begin < end]]
        falls = ~inside | (np.minimum(roof, top) - np.maximum(floor, -climb) > height)
        drop[falls] = np.minimum(drop[falls], -climb - floor[falls])
        i, k = np.arange(len(own)), begin
        while len(i):
            i, k = i[k < end[i]], k[k < end[i]]
            beside = solid.high[k]
            fits = np.minimum(roof[i], ceiling[k]) - np.maximum(floor[i], beside) > height
            j, gap = i[fits], (beside - floor[i])[fits]
            drop[j] = np.minimum(drop[j], gap)
            near, level = j[np.abs(gap) <= climb], beside[fits][np.abs(gap) <= climb]
            lowest[near] = np.minimum(lowest[near], level)
            highest[near] = np.maximum(highest[near], level)
            k = k + 1
    solid.walkable[own[(drop < -climb) | (highest - lowest > climb)]] = False
