"""The top-down map that is built up from the robot's depth images."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import cv2
import numpy as np
from jaxtyping import Float, Float64, UInt8, UInt32

from hypernav.core.embodiment import Embodiment
from hypernav.core.errors import MapError
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.naming.words import megabytes
from hypernav.core.observation import Observation
from hypernav.io.reading import MOST_BYTES
from hypernav.search.mapping.config import (
    BUMP_PERSISTENCE,
    CHUNK_CELLS,
    HIT_WEIGHT,
    MAX_EVIDENCE,
    MAX_SIDE_M,
    OCCUPIED_EVIDENCE,
    PASS_MARGIN_M,
    PASS_MARGIN_RATIO,
    STAIRS_M,
    UNEVEN_M,
    UNEVEN_SHARE,
    HeightBand,
    MappingConfig,
    memory_of,
)
from hypernav.search.mapping.top_down_kernels import (
    FLOOR,
    FREE,
    NO_FLOOR,
    OCCUPIED,
    UNKNOWN,
    integrate_frame,
)

_BUMP_OR_DROP = 128
"""Value of the bumps of older files from which it counts the views of a drop."""


class MapArrays(NamedTuple):
    """The arrays, in the order in which the kernels take them; see `top_down_kernels`."""

    evidence: UInt8[np.ndarray, "rows columns layers"]
    raised: UInt32[np.ndarray, "rows columns"]
    seen: UInt8[np.ndarray, "rows columns"]
    bumps: UInt8[np.ndarray, "rows columns"]
    drops: UInt8[np.ndarray, "rows columns"]
    cells: UInt8[np.ndarray, "rows columns"]


def empty_arrays(rows: int, columns: int, band: HeightBand) -> MapArrays:
    """Arrays of zeros, for which the system hands out memory only when they are written to.

    Raises:
        MapError: They take too much memory.
    """
    if (size := memory_of(rows * columns, band)) > MOST_BYTES:
        raise MapError(
            f"a map of {rows} × {columns} cells would take {megabytes(size)}, at most "
            f"{megabytes(MOST_BYTES)} are allowed; use a larger cell_size_m"
        )
    return MapArrays(
        evidence=np.zeros((rows, columns, band.layers), dtype=np.uint8),
        raised=np.zeros((rows, columns), dtype=np.uint32),
        seen=np.zeros((rows, columns), dtype=np.uint8),
        bumps=np.zeros((rows, columns), dtype=np.uint8),
        drops=np.zeros((rows, columns), dtype=np.uint8),
        cells=np.zeros((rows, columns), dtype=np.uint8),
    )


def enlarged(
    arrays: MapArrays, at: tuple[int, int], rows: int, columns: int, band: HeightBand
) -> MapArrays:
    """Larger arrays that hold the given ones, and zeros elsewhere.

    Args:
        arrays: The arrays so far.
        at: Row and column in the larger arrays at which they begin.
        rows: Number of rows of the larger arrays.
        columns: Number of their columns.
        band: Height band of the map.

    Raises:
        MapError: They take too much memory.
    """
    larger = empty_arrays(rows, columns, band)
    held = tuple(
        slice(first, first + side) for first, side in zip(at, arrays.cells.shape, strict=True)
    )
    for new, old in zip(larger, arrays, strict=True):
        new[held] = old
    return larger


def arrays_of(state: Mapping[str, np.ndarray], band: HeightBand) -> MapArrays:
    """The arrays in a file, by name, which the map goes on to change.

    Raises:
        MapError: They are not those of a map with this height band.
    """
    cells = state["cells"].shape if "cells" in state else ()
    if len(cells) != 2 or min(cells) < 1 or any(side % CHUNK_CELLS for side in cells):
        raise MapError(f"expected the cells of a map in whole chunks, got the shape {cells}")
    arrays = empty_arrays(*cells, band)
    for name, array in arrays._asdict().items():
        found = state.get(name)
        if found is None and name == "drops":
            continue  # the file was written when bumps and drops shared an array
        if found is None or found.shape != array.shape or found.dtype != array.dtype:
            what = "none" if found is None else f"{found.dtype} {found.shape}"
            raise MapError(f"expected {name} as {array.dtype} {array.shape}, found {what}")
        arrays = arrays._replace(**{name: found})
    if (arrays.cells > OCCUPIED).any():
        raise MapError("a cell of the map has a state that none can have")
    if "drops" not in state:
        is_drop = arrays.bumps > _BUMP_OR_DROP
        arrays.drops[is_drop] = arrays.bumps[is_drop] - _BUMP_OR_DROP
        arrays.bumps[is_drop] = 0
    return arrays


class _Window(NamedTuple):
    """The cells that a frame can reach: first row and column, numbers of rows and columns."""

    row: int
    column: int
    rows: int
    columns: int


class TopDownMap:
    """Unknown, free and occupied cells around the robot, in the ``map`` frame.

    The floor is the plane ``z = 0``. Every cell stands for a column of voxels over the height band,
    each with its own evidence. Points raise a voxel's evidence; a ray that passes through a voxel
    lowers it. So a look over a low table does not clear the table, and a table that is carried away
    disappears.

    For a robot that does not climb stairs, a cell is occupied that the image shows to have no
    floor; for one that does it stays unknown, since stairs may lead down there. Right before the
    robot, below the image, a cell of which nothing is known has none where the lowest pixel in its
    direction shows none.

    The map has no fixed size: it grows by chunks of cells, in all directions, aligned to the
    ``map`` frame.
    """

    def __init__(self, config: MappingConfig, embodiment: Embodiment) -> None:
        """Begin with an empty map.

        Args:
            config: Cells, evidence and height band.
            embodiment: Size of the robot and range of its camera.

        Raises:
            ConfigError: The height band is empty, or holds more voxels than the map can keep.
        """
        self.config = config
        self.embodiment = embodiment
        self._band = config.height_band(embodiment.body)
        self._first_row, self._first_column = 0, 0
        self._arrays = empty_arrays(CHUNK_CELLS, CHUNK_CELLS, self._band)
        self._sizes = (config.cell_size_m, config.voxel_height_m, self._band.bottom_m)
        self._weights = (
            config.min_points,
            HIT_WEIGHT,
            config.pass_weight,
            OCCUPIED_EVIDENCE,
            MAX_EVIDENCE,
        )
        self._margins = (PASS_MARGIN_M, PASS_MARGIN_RATIO)
        body = embodiment.body
        self._fall = (math.inf, UNEVEN_SHARE, math.inf)
        if config.sees_drops and body.climbs_stairs:
            self._fall = (2.0 * UNEVEN_M, UNEVEN_SHARE / 2.0, STAIRS_M)
        elif config.sees_drops:
            self._fall = (body.max_step_m + UNEVEN_M, UNEVEN_SHARE, math.inf)
        above_bottom_m = embodiment.camera.height_m - self._band.bottom_m
        to_camera = math.ceil(above_bottom_m / config.voxel_height_m)
        layers = np.arange(max(self._band.layers, to_camera)) + 0.5
        self._eye_layer = min(max(to_camera - 1, 0), self._band.layers - 1)
        voxels_m = self._band.bottom_m + layers * config.voxel_height_m
        self._heights = np.array([self._band.bottom_m / 2.0, *voxels_m])
        self._counts = np.zeros(0, dtype=np.uint16)
        self._touched = np.zeros(0, dtype=np.int32)

    @property
    def grid(self) -> OccupancyGrid:
        """The map's allocated cells: a read-only view, not a copy.

        The view changes with the next `integrate`, and no longer does once the map has grown; ask
        for it again after every frame.
        """
        cells = self._arrays.cells.view()
        cells.flags.writeable = False
        size = self.config.cell_size_m
        return OccupancyGrid(cells, size, (self._first_column * size, self._first_row * size))

    def eye_level(
        self, around: Float64[np.ndarray, "n 2"], *, full_height: bool = False
    ) -> OccupancyGrid:
        """A copy of the map that keeps only obstacles as high as the camera: walls, but no tables.

        All else that is explored counts as free in it.

        Args:
            full_height: Whether to keep only obstacles up to the top of the height band, which the
                camera sees over nowhere in the band.
            around: Points ``(x, y)``, ``map`` frame, metres; beyond the box around them all is left
                unknown, so that the time taken does not grow with the map.
        """
        grid = self.grid
        corners = grid.cells_of(np.array([around.min(axis=0), around.max(axis=0)]))
        window = tuple(slice(max(a, 0), max(b + 1, 0)) for a, b in corners.T.tolist())
        here = grid.cells[window]
        layer = self._band.layers - 1 if full_height else self._eye_layer
        is_low = self._arrays.raised[window] < np.uint32(1 << layer)
        cells = np.zeros(grid.cells.shape, dtype=np.uint8)
        cells[window] = np.where((here == OCCUPIED) & is_low, np.uint8(FREE), here)
        return replace(grid, cells=cells)

    def integrate(self, observation: Observation) -> None:
        """Add one frame to the map.

        Depth that is 0, NaN, infinite, below the sensor's range or at its limits is ignored. Depth
        beyond the range draws nothing, but its ray clears the voxels that it passed. A frame clears
        no voxel that holds one of its points.

        Args:
            observation: Frame with camera and poses in the ``map`` frame.

        Raises:
            MapError: A pose is not finite, or so far away that the map would become wider than
                `MAX_SIDE_M` or take too much memory.
        """
        pose, robot = observation.camera_to_map, observation.robot
        if not (np.isfinite(pose.matrix).all() and math.isfinite(robot.x + robot.y + robot.yaw)):
            raise MapError(
                f"the poses of an observation must be finite, got robot {robot} "
                f"and camera at {pose.translation}"
            )
        config, camera, sensor = self.config, observation.camera, self.embodiment.camera
        radius_m = self.embodiment.body.radius_m
        low, high = camera.reach(pose, sensor.max_depth_m)
        here = np.array(robot.xy)
        self._grow(np.minimum(low, here - radius_m), np.maximum(high, here + radius_m))
        window = self._window(low, high)
        self._reserve(window, observation.depth.size)
        size, corner = config.cell_size_m, self._corner_of(window)
        integrate_frame(
            np.require(observation.depth, np.float32, ["C", "W"]),
            camera.rays_in_voxels(
                pose, (*corner, self._band.bottom_m), (size, size, config.voxel_height_m)
            ),
            (*camera.lens, *sensor.depth_limits_m),
            pose.inverse().rows,
            self._heights,
            tuple(window),
            corner,
            (
                robot.y / size - self._first_row,
                robot.x / size - self._first_column,
                # Half a cell less: a wall or bump right beside the robot is not under it.
                max(radius_m / size - 0.5, 0.5) if config.free_footprint else 0.0,
            ),
            self._sizes,
            self._weights,
            self._margins,
            (float(pose.translation[2]), *self._fall),
            self._counts,
            self._touched,
            tuple(self._arrays),
        )

    def mark_occupied(self, points_xy: Float[np.ndarray, "n 2"]) -> None:
        """Remember positions where the robot bumped into something.

        Such a cell stays occupied whatever the camera shows, until the robot stands on it or
        `BUMP_PERSISTENCE` frames have shown its floor. A drop stays a drop.

        Args:
            points_xy: Positions ``(x, y)``, ``map`` frame, metres. They may lie outside the present
                map.

        Raises:
            MapError: A point is not finite, or too far away.
        """
        if len(points_xy) == 0:
            return
        if not np.isfinite(points_xy).all():
            raise MapError(f"bumped points must be finite, got {points_xy.tolist()}")
        self._grow(
            points_xy.min(axis=0).astype(np.float64), points_xy.max(axis=0).astype(np.float64)
        )
        for row, column in self.grid.cells_of(points_xy):
            if self._arrays.drops[row, column] == 0:
                self._arrays.bumps[row, column] = BUMP_PERSISTENCE
            self._arrays.cells[row, column] = OCCUPIED

    def has_drop(self, points_xy: Float[np.ndarray, "n 2"]) -> bool:
        """Whether a drop is known at one of some positions ``(x, y)``, ``map`` frame, metres."""
        cells = self.grid.cells_of(points_xy)
        return bool(self._arrays.drops[tuple(cells[self.grid.contains(cells)].T)].any())

    def edges_to_drops(self) -> Float64[np.ndarray, "n 2"]:
        """Middles ``(x, y)`` of cells without floor that are beside free ones, metres.

        Empty for a robot that doesn't climb, to which such cells are obstacles.
        """
        no_floor = self._arrays.seen == NO_FLOOR
        left, top, width, height = cv2.boundingRect(no_floor.view(np.uint8))
        first = np.array([max(top - 1, 0), max(left - 1, 0)])
        window = np.s_[first[0] : top + height + 1, first[1] : left + width + 1]
        is_free = (self.grid.cells[window] == FREE).view(np.uint8)
        beside = cv2.dilate(is_free, np.ones((3, 3), np.uint8))
        return self.grid.centres_of(np.argwhere(no_floor[window] & (beside > 0)) + first)

    def shows_obstacle(self, points_xy: Float[np.ndarray, "n 2"]) -> bool:
        """Whether images show an obstacle at one of some positions ``(x, y)``, metres.

        Bumps are none: what the robot touched may be anywhere before it.
        """
        cells = self.grid.cells_of(points_xy)
        evidence = self._arrays.evidence[tuple(cells[self.grid.contains(cells)].T)]
        return bool((evidence >= OCCUPIED_EVIDENCE).any())

    def forget_bumps(self) -> None:
        """Forget all bumps, but no drops: such cells get the state that the images give them."""
        arrays = self._arrays
        bumped = arrays.bumps > 0
        occupied = (arrays.evidence[bumped] >= OCCUPIED_EVIDENCE).any(axis=1)
        free = np.where(arrays.seen[bumped] == FLOOR, FREE, UNKNOWN)
        arrays.cells[bumped] = np.where(occupied, OCCUPIED, free)
        arrays.bumps[bumped] = 0

    @property
    def state(self) -> dict[str, np.ndarray]:
        """All that the map knows, by name, as arrays for a file; see `restore`."""
        first = np.array([self._first_row, self._first_column], dtype=np.int64)
        return {"first": first, **self._arrays._asdict()}

    def restore(self, state: Mapping[str, np.ndarray]) -> None:
        """Take over what another map with the same configuration knew.

        Raises:
            MapError: The arrays are not those of such a map.
        """
        arrays = arrays_of(state, self._band)
        far, first = MAX_SIDE_M / self.config.cell_size_m, state.get("first")
        if first is None or first.shape != (2,) or first.dtype != np.int64:
            raise MapError("expected the row and column of the first cell of the map as int64 (2,)")
        if (np.abs(first.astype(float)) > far).any():
            raise MapError("a cell of the map lies too far away")
        self._arrays = arrays
        self._first_row, self._first_column = first.tolist()

    def _grow(self, low: Float64[np.ndarray, "2"], high: Float64[np.ndarray, "2"]) -> None:
        """Make the map hold the box between two corners ``(x, y)``, metres, in whole chunks."""
        size = self.config.cell_size_m
        # One cell more on each side: what is explored never touches the edge of the grid.
        first = np.floor(low / size) - 1
        last = np.floor(high / size) + 1
        rows, columns = self._arrays.cells.shape
        first = np.minimum(first, [self._first_column, self._first_row])
        last = np.maximum(last, [self._first_column + columns - 1, self._first_row + rows - 1])
        side = float((last - first).max() + 1) * size
        if side > MAX_SIDE_M + 2 * CHUNK_CELLS * size:
            raise MapError(
                f"the map would become {side:.0f} m wide, at most {MAX_SIDE_M:g} m are "
                f"allowed; is a pose wrong? (points from {low} to {high})"
            )
        begin = first // CHUNK_CELLS * CHUNK_CELLS
        sides = -(-(last + 1 - begin) // CHUNK_CELLS) * CHUNK_CELLS
        (column, row), (new_columns, new_rows) = (
            one.astype(int).tolist() for one in (begin, sides)
        )
        if (new_rows, new_columns) == (rows, columns):
            return
        at = (self._first_row - row, self._first_column - column)
        self._arrays = enlarged(self._arrays, at, new_rows, new_columns, self._band)
        self._first_row, self._first_column = row, column

    def _window(self, low: Float64[np.ndarray, "2"], high: Float64[np.ndarray, "2"]) -> _Window:
        """The cells of the box between two corners ``(x, y)``, metres, which the map holds."""
        size = self.config.cell_size_m
        column, row = (int(c) for c in np.floor(low / size))
        last_column, last_row = (int(c) for c in np.floor(high / size))
        return _Window(
            row=row - self._first_row,
            column=column - self._first_column,
            rows=last_row - row + 1,
            columns=last_column - column + 1,
        )

    def _corner_of(self, window: _Window) -> tuple[float, float]:
        """Lower left corner ``(x, y)`` of a window, metres."""
        size = self.config.cell_size_m
        return (self._first_column + window.column) * size, (self._first_row + window.row) * size

    def _reserve(self, window: _Window, pixels: int) -> None:
        """Allocate scratch memory for a frame."""
        voxels = window.rows * window.columns * self._band.layers
        if self._counts.size < voxels:
            self._counts = np.zeros(voxels, dtype=np.uint16)
        if self._touched.size < pixels:
            self._touched = np.zeros(pixels, dtype=np.int32)
