"""The voxels' heights under one polygon, as ``getHeightData`` and ``getHeight`` of Recast."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float32, Int32, Int64

from hypernav.worlds.navmesh.recast.detail.height_kernels import grow
from hypernav.worlds.navmesh.recast.voxels.open_space import NOTHING, OpenSpace

UNSET = 0xFFFF
_AROUND = ((0, 0), (-1, -1), (0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0))
_SHIFT = np.float32(0.01)


class Sampling(NamedTuple):
    """How heights are sampled; all in single precision.

    Attributes:
        cell: Side of a column, metres.
        cell_height: Height of a voxel, metres.
        spacing: Distance of samples, metres.
        most_error: Greatest accepted error of a height, metres.
        reach: Columns around a sample in which a height is looked for.
    """

    cell: np.float32
    cell_height: np.float32
    spacing: np.float32
    most_error: np.float32
    reach: int


class Regions:
    """Regions of the open space, and which spans lie at their borders."""

    def __init__(self, space: OpenSpace, numbers: Int32[np.ndarray, " s"]) -> None:
        """Look for the borders.

        Args:
            space: Open space, eroded.
            numbers: Region of every span.
        """
        beside = space.neighbours
        self.space, self.numbers = space, numbers
        self.at_border: Bool[np.ndarray, " s"] = (
            (beside != NOTHING) & (numbers[beside] != numbers[:, None])
        ).any(axis=1)


class Patch:
    """Heights over a polygon's box: those of its region, grown to what can be walked to from there.

    Attributes:
        heights: By column z and column x, voxels; `UNSET` where none is known.
        x_low: Column along x of the first entry.
        z_low: Column along z of the first entry.
    """

    def __init__(self, regions: Regions, region: int, points: Int64[np.ndarray, "c 3"]) -> None:
        """Find the heights.

        Args:
            regions: Regions of the open space.
            region: Region of the polygon.
            points: Corners of the polygon (column x, height in voxels, column z).
        """
        space = regions.space
        self.x_low, self.z_low = (max(int(points[:, axis].min()) - 1, 0) for axis in (0, 2))
        x = np.arange(self.x_low, min(int(points[:, 0].max()) + 1, space.width))
        z = np.arange(self.z_low, min(int(points[:, 2].max()) + 1, space.depth))
        column = x + z[:, None] * space.width
        span = _first_of_region(regions, region, column)
        self.heights: Int32[np.ndarray, "z x"] = np.where(
            span == NOTHING, UNSET, space.floor[span]
        ).astype(np.int32)
        seeds = span[(span != NOTHING) & regions.at_border[span]]
        if (span == NOTHING).all():
            seeds = np.array([self._span_at_middle(space, points)])
            self.heights[space.z[seeds] - self.z_low, space.x[seeds] - self.x_low] = space.floor[
                seeds
            ]
        queue = np.empty(column.size + 1, dtype=np.int64)
        queue[: len(seeds)] = seeds
        grow(
            space.neighbours,
            space.x,
            space.z,
            space.floor,
            self.heights,
            self.x_low,
            self.z_low,
            UNSET,
            queue,
            len(seeds),
        )

    def at(self, points: Float32[np.ndarray, "n 3"], sampling: Sampling) -> Int32[np.ndarray, " n"]:
        """Heights at points, voxels; where unset, of the entries around that nearest to its own.

        Args:
            points: Points, metres from the lowest corner.
            sampling: How heights are sampled.
        """
        last = np.array(self.heights.shape) - 1
        per_cell = np.float32(1.0) / sampling.cell
        place = np.floor(points[:, [2, 0]] * per_cell + _SHIFT).astype(np.int64)
        row, column = np.clip(place - (self.z_low, self.x_low), 0, last).T
        heights = self.heights[row, column]
        for ring in range(1, sampling.reach + 1):
            unset = np.flatnonzero(heights == UNSET)
            if len(unset) == 0:
                break
            dz, dx = _ring(ring).T
            r, c = row[unset, None] + dz, column[unset, None] + dx
            inside = (r >= 0) & (r <= last[0]) & (c >= 0) & (c <= last[1])
            around = self.heights[np.clip(r, 0, last[0]), np.clip(c, 0, last[1])]
            around[~inside] = UNSET
            gap = np.abs(around.astype(np.float32) * sampling.cell_height - points[unset, 1, None])
            gap[around == UNSET] = np.inf
            nearest = gap.argmin(axis=1)
            heights[unset] = around[np.arange(len(unset)), nearest]
        return heights

    def _span_at_middle(self, space: OpenSpace, points: Int64[np.ndarray, "c 3"]) -> int:
        """The span at a polygon's middle, reached from a corner without leaving the patch."""
        middle_x, _, middle_z = (points.sum(axis=0) // len(points)).tolist()
        i = self._span_at_corner(space, points)
        stack, seen, directions = [i], set(), [0, 1, 2, 3]
        while stack:
            i = stack.pop()
            x, z = int(space.x[i]), int(space.z[i])
            if (x, z) == (middle_x, middle_z):
                break
            straight = (1 if middle_z > z else 3) if x == middle_x else 2 if middle_x > x else 0
            # The last one that is put onto the stack is the next one taken.
            directions[straight], directions[3] = directions[3], directions[straight]
            for direction in directions:
                beside = int(space.neighbours[i, direction])
                if beside == NOTHING or not self._has(space.x[beside], space.z[beside]):
                    continue
                place = int(space.x[beside]), int(space.z[beside])
                if place not in seen:
                    seen.add(place)
                    stack.append(beside)
            directions[straight], directions[3] = directions[3], directions[straight]
        return i

    def _span_at_corner(self, space: OpenSpace, points: Int64[np.ndarray, "c 3"]) -> int:
        """The span nearest in height to a corner of a polygon, at the corner or beside it."""
        nearest, gap = 0, UNSET
        for corner_x, height, corner_z in points.tolist():
            for dx, dz in _AROUND:
                x, z = corner_x + dx, corner_z + dz
                if not self._has(x, z):
                    continue
                begin, end = space.start[x + z * space.width :][:2]
                for i in range(begin, end):
                    if abs(height - int(space.floor[i])) < gap:
                        nearest, gap = i, abs(height - int(space.floor[i]))
        return nearest

    def _has(self, x: int, z: int) -> bool:
        rows, columns = self.heights.shape
        return 0 <= x - self.x_low < columns and 0 <= z - self.z_low < rows


def _first_of_region(
    regions: Regions, region: int, column: Int64[np.ndarray, "z x"]
) -> Int64[np.ndarray, "z x"]:
    """The lowest span of a region in each column."""
    start = regions.space.start
    span = np.full(column.shape, NOTHING)
    begin, end = start[column], start[column + 1]
    for layer in range(int((end - begin).max(initial=0)) - 1, -1, -1):
        i = begin + layer
        # The lowest layer is looked at last and counts.
        own = (i < end) & (regions.numbers[np.minimum(i, len(regions.numbers) - 1)] == region)
        span[own] = i[own]
    return span


@lru_cache
def _ring(ring: int) -> Int64[np.ndarray, "n 2"]:
    """Places around one, by z and x, in the order of Recast, which decides between equal ones."""
    places, dx, dz, step_x, step_z = [], ring, 1 - ring, 0, 1
    for _ in range(8 * ring):
        places.append((dz, dx))
        if (dx == ring and dz == ring) or (dx == -ring and abs(dz) == ring):
            step_x, step_z = -step_z, step_x
        dx, dz = dx + step_x, dz + step_z
    return np.array(places)
