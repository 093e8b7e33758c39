"""The heights of the ground around a robot that climbs, and what of it can be walked on."""

import math
from dataclasses import dataclass, replace
from functools import cached_property

import cv2
import numpy as np
from jaxtyping import Bool, Float32, Float64, UInt8

from hypernav.core.embodiment import Embodiment
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.observation import Observation
from hypernav.search.mapping.config import OCCUPIED_EVIDENCE
from hypernav.search.mapping.elevation_kernels import (
    BUMPED,
    open_ground,
    sort_ground,
    survey,
)
from hypernav.search.mapping.grid_kernels import nearest_open_cell
from hypernav.search.mapping.inflation import disc, distance_from, joined_to

_NEAR_M = 0.4
"""Distance within which the ground under the robot is looked for, metres."""

LEVEL_M = 0.08
"""Greatest height above or below a floor, metres, that belongs to it: rugs and sills do. Heights
that images show of level ground err by less."""
SIDE_CELLS = 256
"""Number of rows and columns of the map, whose middle stays near the robot."""
NEAR_CELLS = 160
"""Number of rows and columns, around the robot, in which stairs are looked for."""
_SHIFT_CELLS = 32
"""Cells by which the map moves with the robot."""
_LEAST_CELLS = 20
SAME_STOREY_M = 1.6
"""Height above or below the robot, metres, beyond which ground is of another storey."""
_UNDER_M = 0.1
"""Distance within which the ground is what the robot stands on, metres."""
_OTHER_M = 0.6
"""Difference in height from which it must be of another storey, metres: treads are kept."""
_NEAR_LEVEL_M = 0.5
"""Height above or below the robot, metres, of the ground from which the blind zone is filled in."""
_SPOT_M = 0.45
"""Side of a square, metres: unseen ground in the midst of seen ground that it doesn't fit into is
ground. Where a simulated robot stands a step too high, single rays seem to pass below the floor."""
_PIT_M = 0.15
"""Side of a square, metres: pits that it doesn't fit into are filled."""
_STEP_SLACK_M = 0.04
"""Addition to the highest step, metres, for errors of measured heights."""
_CLEARANCE = 0.65
"""Distance from edges and obstacles that a climbing robot's middle keeps, by its radius."""
_AROUND_M = 0.5
"""Distance beyond what the camera doesn't see of the ground before the robot, metres, within which
the ground tells how high the robot stands."""
POSE_ERROR_M = 0.3
"""Greatest error of the height at which the robot is said to be, metres."""
_LEAST_AGREEING = 0.25
"""Share of the ground that must agree: then the rest is another level, such as a raised room."""


@dataclass(frozen=True, eq=False)
class UnseenGround:
    """The unseen cells that count as ground, as right before the robot.

    Attributes:
        cells: Mask of them.
        around: Heights from which theirs are filled in, metres; NaN where none is known.
    """

    cells: Bool[np.ndarray, "rows columns"]
    around: Float32[np.ndarray, "rows columns"]

    @cached_property
    def heights(self) -> Float32[np.ndarray, "rows columns"]:
        """Heights of all cells as filled in, metres; worked out when they are asked for."""
        return filled(self.around)


@dataclass(frozen=True, eq=False)
class Ground:
    """The part of the ground that the robot could walk to over steps that it can climb.

    What only few steps need is worked out when it is asked for.

    Attributes:
        grid: The open ground, free where the robot could step on it and occupied elsewhere.
        measured: Height of the ground where it was seen, ``map`` frame, metres; where steps down
            are presumed, an upper bound; NaN elsewhere.
        seen: Mask of the cells whose ground was seen.
        reached: Mask of the cells where the robot's middle could get.
        presumed: Mask of the cells where stairs down are presumed, since no ground was seen at the
            robot's height, but what lies below it.
        least_m: Clearance that the robot's middle needs, metres.
        unseen: The unseen cells that count as ground.
        stood: Mask of the cells whose height is that of a robot that stood there, and that no image
            has shown since.
    """

    grid: OccupancyGrid
    measured: Float32[np.ndarray, "rows columns"]
    seen: Bool[np.ndarray, "rows columns"]
    reached: Bool[np.ndarray, "rows columns"]
    presumed: Bool[np.ndarray, "rows columns"]
    least_m: float
    unseen: UnseenGround
    stood: Bool[np.ndarray, "rows columns"]

    @cached_property
    def heights(self) -> Float32[np.ndarray, "rows columns"]:
        """Heights of the ground, metres: where it was not seen, filled in; else as measured."""
        return np.where(self.unseen.cells, self.unseen.heights, self.measured)

    @cached_property
    def clearance_m(self) -> Float32[np.ndarray, "rows columns"]:
        """Distance of every cell from what is not open ground, metres."""
        return distance_from(~self.grid.free) * np.float32(self.grid.resolution_m)

    def without(
        self, closed: Bool[np.ndarray, "rows columns"], position: tuple[float, float]
    ) -> "Ground":
        """The ground where some cells are closed, as far as it is in reach from a position."""
        cells = np.where(closed, np.uint8(Cell.OCCUPIED), self.grid.cells)
        grid = replace(self.grid, cells=cells)
        return replace(self, grid=grid, reached=reach(grid, position, self.least_m))

    def between(self, low_m: float, high_m: float) -> Bool[np.ndarray, "rows columns"]:
        """Mask of the reached cells whose heights lie between two, metres."""
        with np.errstate(invalid="ignore"):
            return self.reached & (self.heights >= low_m) & (self.heights <= high_m)

    def area_m2(self, mask: Bool[np.ndarray, "rows columns"]) -> float:
        """Area of a mask's cells, square metres."""
        return float(mask.sum()) * self.grid.resolution_m**2

    def nearest_reached(self, position: tuple[float, float]) -> tuple[int, int] | None:
        """The reached cell ``(row, column)`` nearest to a position; None if none is near it."""
        return nearest_cell(self.reached, self.grid, position)

    def distances_m(self, position: tuple[float, float]) -> Float64[np.ndarray, "rows columns"]:
        """Straight distances of all cells from a position, metres."""
        row, column = self.grid.cell_of(*position)
        rows, columns = np.ogrid[: self.heights.shape[0], : self.heights.shape[1]]
        return np.hypot(rows - row, columns - column) * self.grid.resolution_m

    def along(
        self, position: tuple[float, float], axis: float
    ) -> tuple[Float64[np.ndarray, "rows columns"], Float64[np.ndarray, "rows columns"]]:
        """How far ahead of a position along an axis (radians), and beside it, cells lie, metres."""
        row, column = self.grid.cell_of(*position)
        rows, columns = np.ogrid[: self.heights.shape[0], : self.heights.shape[1]]
        y, x = (rows - row) * self.grid.resolution_m, (columns - column) * self.grid.resolution_m
        cos, sin = math.cos(axis), math.sin(axis)
        return x * cos + y * sin, np.abs(y * cos - x * sin)

    def positions(self, mask: Bool[np.ndarray, "rows columns"]) -> Float64[np.ndarray, "n 2"]:
        """Middles ``(x, y)`` of a mask's cells, metres."""
        return self.grid.centres_of(np.argwhere(mask))


def reach(
    grid: OccupancyGrid, position: tuple[float, float], least_m: float
) -> Bool[np.ndarray, "rows columns"]:
    """Mask of the cells that keep clear of what is not free, in reach of a position.

    Args:
        grid: Free and other cells.
        position: The robot ``(x, y)``, metres.
        least_m: Clearance that its middle needs, metres.
    """
    is_open = (grid.cells == Cell.FREE).view(np.uint8)
    fits = cv2.erode(is_open, disc(least_m, grid.resolution_m))
    start = nearest_cell(fits > 0, grid, position)
    if start is None:
        return np.zeros(fits.shape, dtype=np.bool_)
    return joined_to(start, fits > 0)


def closed(mask: Bool[np.ndarray, "rows columns"], side: int) -> Bool[np.ndarray, "rows columns"]:
    """The mask with its gaps that a square of so many cells doesn't fit into."""
    square = np.ones((side, side), np.uint8)
    return cv2.morphologyEx(mask.view(np.uint8), cv2.MORPH_CLOSE, square) > 0


def nearest_cell(
    mask: Bool[np.ndarray, "rows columns"], grid: OccupancyGrid, position: tuple[float, float]
) -> tuple[int, int] | None:
    """The cell of a mask nearest to a position; None if none is within `_NEAR_M`."""
    within = math.ceil(_NEAR_M / grid.resolution_m)
    cell = nearest_open_cell(mask.view(np.uint8), *grid.cell_of(*position), within)
    return None if cell == (-1, -1) else cell


def filled(heights: Float32[np.ndarray, "rows columns"]) -> Float32[np.ndarray, "rows columns"]:
    """The heights with all gaps filled in: averages of what is known around, the nearest first.

    The pyramid of Gortler et al., "The Lumigraph", 1996 ("pull and push").
    """
    known = ~np.isnan(heights)
    weights = [known.astype(np.float32)]
    totals = [np.where(known, heights, np.float32(0.0))]
    while min(weights[-1].shape) > 1 and (weights[-1] == 0.0).any():
        half = (weights[-1].shape[1] // 2, weights[-1].shape[0] // 2)
        sums = [
            cv2.resize(one, half, interpolation=cv2.INTER_AREA) for one in (weights[-1], totals[-1])
        ]
        mean = sums[1] / np.maximum(sums[0], 1e-9)
        weights.append(np.minimum(sums[0] * 4.0, 1.0))
        totals.append(mean * weights[-1])
    level = totals[-1] / np.maximum(weights[-1], 1e-9)
    for weight, total in zip(weights[-2::-1], totals[-2::-1], strict=True):
        wider = cv2.resize(level, total.shape[::-1], interpolation=cv2.INTER_LINEAR)
        level = total + (1.0 - weight) * wider
    return level


class ElevationMap:
    """Heights of level ground, in cells around the robot; it moves along with it.

    A cell has one height, that of the highest level surface below the camera in the latest frame
    that showed one: floor, tread or tabletop. Robot-centric as in Fankhauser et al.,
    "Probabilistic Terrain Mapping for Mobile Robots with Uncertain Localization", 2018, but without
    variances.
    """

    def __init__(self, embodiment: Embodiment, cell_size_m: float) -> None:
        """Begin with nothing known.

        Args:
            embodiment: Size of the robot, its highest step, and the range of its camera.
            cell_size_m: Side of a cell, metres.
        """
        self._embodiment = embodiment
        self._cell_m = cell_size_m
        self._spot_cells = 2 * round(0.5 * (_SPOT_M / cell_size_m - 1.0)) + 1  # an odd number
        self._pit_cells = 2 * math.ceil(0.5 * (_PIT_M / cell_size_m - 1.0)) + 1
        shape = (SIDE_CELLS, SIDE_CELLS)
        self._heights = np.full(shape, np.nan, dtype=np.float32)
        self._stood_z = np.full(shape, np.nan, dtype=np.float32)
        self._hits = np.zeros(shape, dtype=np.uint8)
        self._hit_z = np.zeros(shape, dtype=np.float32)
        self._hit_top = np.zeros(shape, dtype=np.float32)
        self._below = np.full(shape, np.inf, dtype=np.float32)
        self._scratch = (
            np.full(shape, -np.inf, dtype=np.float32),
            np.zeros(shape, dtype=np.uint8),
            np.zeros(SIDE_CELLS * SIDE_CELLS, dtype=np.int32),
        )
        self._ground_z = 0.0
        self._corner: tuple[int, int] | None = None
        self._blind_m = embodiment.camera.floor_from_m + 2 * cell_size_m

    @property
    def ground_z(self) -> float:
        """Height of the ground that the robot stands on, as images show it, metres.

        Where none has shown it yet, and on stairs, it is where the robot is said to be. That may be
        wrong: meshes float above floors, odometry drifts, a camera is mounted lower than it should.
        """
        return self._ground_z

    def integrate(self, observation: Observation, *, on_stairs: bool = False) -> bool:
        """Add a frame, whose heights are those of the ``map`` frame.

        Args:
            observation: The frame.
            on_stairs: Whether the robot climbs, so that the ground around it lies at many heights.

        Returns:
            Whether it shows enough ground a step or two above or below the robot's, or depth
            below it, to look for stairs.
        """
        self._centre(*observation.robot.xy)
        pose, camera = observation.camera_to_map, observation.camera
        body, sensor = self._embodiment.body, self._embodiment.camera
        x, y = camera.ray_slopes()
        across = x[:, None] * pose.rotation[:, 0]
        down = y[:, None] * pose.rotation[:, 1] + pose.rotation[:, 2]
        said_z = sensor.base_z(pose)
        self._stand(observation.robot.xy, said_z)
        ground_z = said_z if on_stairs else self._seen_z(observation.robot.xy, said_z)
        self._ground_z = float(np.float32(round(ground_z, 2)))  # a value that the map can hold
        off_level = survey(
            np.require(observation.depth, np.float32, ["C", "W"]),
            across.astype(np.float32),
            down.astype(np.float32),
            tuple(pose.translation.tolist()),
            sensor.depth_limits_m,
            (self._ground_z, body.height_m, body.max_step_m + _STEP_SLACK_M),
            (*self._origin, self._cell_m),
            (self._heights, self._hits, self._hit_z, self._hit_top, self._below),
            self._scratch,
        )
        return off_level >= _LEAST_CELLS

    @property
    def obstacles(self) -> OccupancyGrid:
        """What stands on the ground: occupied, and unknown elsewhere."""
        is_hit = self._hits >= OCCUPIED_EVIDENCE
        cells = np.where(is_hit, np.uint8(Cell.OCCUPIED), np.uint8(Cell.UNKNOWN))
        return OccupancyGrid(cells, self._cell_m, self._origin)

    def mark_occupied(self, points_xy: Float64[np.ndarray, "n 2"]) -> None:
        """Remember the middle of positions ``(x, y)``, metres, where the robot has bumped.

        On stairs all that is near would close the way.
        """
        if len(points_xy):
            middle = points_xy.mean(axis=0, keepdims=True)
            self._hits[self.obstacles.mask_of(middle)] = BUMPED

    def ground_from(
        self, position: tuple[float, float], *, down: bool = False, under: bool = False
    ) -> Ground:
        """What the robot could walk to from a position.

        Args:
            position: The robot ``(x, y)``, metres.
            down: Whether unseen steps down are presumed where nothing but the depth below was seen.
            under: Whether what is higher than the robot is tall is none, since it goes under that.
        """
        body = self._embodiment.body
        robot_z = self._ground_z
        window, origin = self._window(position)
        maps = (self._heights, self._hits, self._hit_z, self._hit_top, self._below)
        known, hits, hit_z, hit_top, below = (one[window] for one in maps)
        with np.errstate(invalid="ignore"):  # what is farther up or down belongs to other storeys
            known = _without_pits(known, self._pit_cells, body.max_step_m)
            highest_m = min(body.height_m, SAME_STOREY_M) if under else SAME_STOREY_M
            measured = (known >= robot_z - SAME_STOREY_M) & (known <= robot_z + highest_m)
            near_level = np.abs(known - robot_z) < _NEAR_LEVEL_M
        around = np.where(near_level, known, np.float32(np.nan))
        seen = closed(measured, 3)  # gaps of one cell, as at risers, are ground
        spots = closed(seen, self._spot_cells)
        # What lies lower may be joined to the robot by steps that it does not see.
        step_m = body.max_step_m + _STEP_SLACK_M
        to_robot = (origin[0] - position[0], origin[1] - position[1], self._cell_m)
        heights, blind, presumed, clear = sort_ground(
            (known, hits, hit_z, hit_top, below),
            (measured, seen, spots),
            to_robot,
            np.float32(robot_z),
            (self._blind_m, step_m, np.float32(body.height_m)),
            down,
        )
        unseen = UnseenGround(blind, around)
        even = heights if down else np.where(blind, unseen.heights, heights)
        under_m = body.radius_m + _UNDER_M
        cells = open_ground(even, seen | blind, clear, presumed, to_robot, under_m, step_m)
        grid = OccupancyGrid(cells, self._cell_m, origin)
        least_m = _CLEARANCE * body.radius_m
        reached = reach(grid, position, least_m)
        measured_z = np.where(presumed & ~blind, below, heights) if presumed.any() else heights
        stood = self._stood_z[window] == self._heights[window]
        return Ground(grid, measured_z, seen, reached, presumed, least_m, unseen, stood)

    @property
    def _origin(self) -> tuple[float, float]:
        row, column = self._corner or (0, 0)
        return (column * self._cell_m, row * self._cell_m)

    def _window(
        self, position: tuple[float, float]
    ) -> tuple[tuple[slice, slice], tuple[float, float]]:
        """The part of the map around a position, and its lower left corner, metres."""
        row0, column0 = self._corner or (0, 0)
        first = (one - NEAR_CELLS // 2 for one in self._cell_of(position))
        row, column = (min(max(one, 0), SIDE_CELLS - NEAR_CELLS) for one in first)
        origin = ((column0 + column) * self._cell_m, (row0 + row) * self._cell_m)
        return (slice(row, row + NEAR_CELLS), slice(column, column + NEAR_CELLS)), origin

    def _cell_of(self, position: tuple[float, float]) -> tuple[int, int]:
        """Row and column of a position ``(x, y)``, metres."""
        row0, column0 = self._corner or (0, 0)
        return (
            math.floor(position[1] / self._cell_m) - row0,
            math.floor(position[0] / self._cell_m) - column0,
        )

    def _centre(self, x: float, y: float) -> None:
        """Move the map along with the robot, by whole cells."""
        at = (math.floor(y / self._cell_m), math.floor(x / self._cell_m))
        if self._corner is None:
            self._corner = (at[0] - SIDE_CELLS // 2, at[1] - SIDE_CELLS // 2)
        row, column = self._corner
        off = (at[0] - row - SIDE_CELLS // 2, at[1] - column - SIDE_CELLS // 2)
        shift = tuple(
            0 if abs(one) < _SHIFT_CELLS else round(one / _SHIFT_CELLS) * _SHIFT_CELLS
            for one in off
        )
        if shift == (0, 0):
            return
        self._heights = _shifted(self._heights, shift, np.float32(np.nan))
        self._stood_z = _shifted(self._stood_z, shift, np.float32(np.nan))
        self._hits = _shifted(self._hits, shift, np.uint8(0))
        self._hit_z = _shifted(self._hit_z, shift, np.float32(0.0))
        self._hit_top = _shifted(self._hit_top, shift, np.float32(0.0))
        self._below = _shifted(self._below, shift, np.float32(np.inf))
        self._corner = (row + shift[0], column + shift[1])

    def _stand(self, position: tuple[float, float], floor_z: float) -> None:
        """The robot stands on ground, which its camera does not see."""
        row, column = self._cell_of(position)
        reach = round(_UNDER_M / self._cell_m)
        window = np.s_[row - reach : row + reach + 1, column - reach : column + reach + 1]
        self._hits[window] = 0
        with np.errstate(invalid="ignore"):
            is_other = ~(np.abs(self._heights[window] - floor_z) <= _OTHER_M)
        self._heights[window][is_other] = floor_z
        self._stood_z[window][is_other] = floor_z

    def _seen_z(self, position: tuple[float, float], said_z: float) -> float:
        """The height of the level ground around the robot, as images show it, metres.

        Args:
            position: The robot ``(x, y)``, metres.
            said_z: The height at which it is said to be, metres.
        """
        row, column = self._cell_of(position)
        reach = math.ceil((self._blind_m + _AROUND_M) / self._cell_m)
        rows, columns = (slice(max(i - reach, 0), i + reach + 1, 2) for i in (row, column))
        heights = self._heights[rows, columns]  # every other row and column tells enough
        off_m = np.abs(heights - np.float32(said_z))
        with np.errstate(invalid="ignore"):
            is_near = (off_m <= POSE_ERROR_M) & (heights != self._stood_z[rows, columns])
        near = heights[is_near]
        agrees = off_m[is_near] <= LEVEL_M
        if agrees.sum() >= _LEAST_AGREEING * len(near):
            near = near[agrees]
        return float(np.median(near)) if len(near) else said_z


def _without_pits(
    heights: Float32[np.ndarray, "rows columns"], side: int, least_m: float
) -> Float32[np.ndarray, "rows columns"]:
    """The heights, where pits narrower than so many cells are filled if so deep, metres.

    What was seen below a landing stays in cells that no ray meets as it is seen from above.
    """
    square = np.ones((side, side), np.uint8)
    closed = cv2.morphologyEx(np.fmax(heights, -np.inf), cv2.MORPH_CLOSE, square)
    return np.where(closed - heights > least_m, closed, heights)


def _shifted(
    array: Float32[np.ndarray, "rows columns"]
    | UInt8[np.ndarray, "rows columns"]
    | Bool[np.ndarray, "rows columns"],
    shift: tuple[int, ...],
    fill: np.generic,
) -> np.ndarray:
    """The array after a move of its window by rows and columns; what is new is filled."""
    moved = np.full_like(array, fill)
    (i, j), (rows, columns) = shift, array.shape
    if abs(i) < rows and abs(j) < columns:
        moved[max(-i, 0) : rows - max(i, 0), max(-j, 0) : columns - max(j, 0)] = array[
            max(i, 0) : rows + min(i, 0), max(j, 0) : columns + min(j, 0)
        ]
    return moved
