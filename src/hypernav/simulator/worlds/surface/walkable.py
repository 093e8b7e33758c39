"""Walkable surface of a storey, computed from the triangles of a scene."""

import math
from bisect import bisect
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int32

from hypernav.core.embodiment import BodyConfig
from hypernav.core.errors import SceneError, StartError
from hypernav.core.geometry.grid import has_cell
from hypernav.core.world import Position
from hypernav.simulator.worlds.config import CELL_M
from hypernav.simulator.worlds.scenes.scene import Scene
from hypernav.simulator.worlds.surface.geodesic import DistanceField, FreeSpace
from hypernav.simulator.worlds.surface.storey_floors import Storey, find_storey
from hypernav.simulator.worlds.surface.walkable_kernels import label_components, slide, walk
from hypernav.simulator.worlds.surface.walkable_surface import is_near_box

_SMALLEST_ISLAND_M2 = 1.0
"""Smaller isolated parts are the insides of furniture and gaps behind it."""
_STOREY_M = 1.0
_UNEVEN_M = 0.15
"""By how much what a thing stands on may be lower than the floor of its storey."""
_ROUNDING = 1e-6
"""Cells."""


@dataclass(frozen=True, eq=False)
class WalkableGrid:
    """The truth about one storey: standable cells, their heights, and the paths between them.

    Positions are x and y of the scene frame, metres; heights ``z``, which distinguish storeys, are
    not needed. A position is standable if its cell is. Paths may run along the border of standable
    cells, but never pass between two diagonal cells.

    Attributes:
        standable: Cells where the robot's middle may be.
        heights: Floor height of every standable cell, metres; NaN elsewhere.
        components: Connected part of every cell: 0 is the main one, the largest unless another
            has the building's things or ceilings (`by_importance`); -1 is not standable.
        cell_m: Side of a cell.
        origin: Lower left corner of cell (0, 0).
        floor_z: Height of the storey's floor (median).
        holds_z: Heights from which and below which the lowest points of things on this storey
            are; without bounds if the scene is not known to have several storeys.
    """

    standable: Bool[np.ndarray, "rows columns"]
    heights: Float32[np.ndarray, "rows columns"]
    components: Int32[np.ndarray, "rows columns"]
    cell_m: float
    origin: tuple[float, float]
    floor_z: float
    holds_z: tuple[float, float] = (-math.inf, math.inf)

    @staticmethod
    def from_scene(
        scene: Scene,
        robot: BodyConfig | None = None,
        *,
        cell_m: float = CELL_M,
        floor_z: float | None = None,
    ) -> "WalkableGrid":
        """Compute where a robot fits.

        Args:
            scene: All its triangles count, whatever they belong to: a closed door is an obstacle.
            robot: Robot that has to fit.
            cell_m: Side of a cell; the robot's clearance is kept to this accuracy.
            floor_z: Height of the wanted storey's floor, metres; None takes the main storey.

        Raises:
            SceneError: The robot can stand nowhere in the scene (or on that storey).
        """
        robot = robot or BodyConfig()
        grid = _grid_of(find_storey(scene, robot, cell_m=cell_m, floor_z=floor_z), robot)
        edges = [-math.inf, *(z - _UNEVEN_M for z in scene.storeys[1:]), math.inf]
        storey = bisect(edges, grid.floor_z) - 1
        return replace(grid, holds_z=(edges[storey], edges[storey + 1]))

    @staticmethod
    def from_mask(
        standable: Bool[np.ndarray, "rows columns"],
        *,
        cell_m: float = CELL_M,
        origin: tuple[float, float] = (0.0, 0.0),
        floor_z: float = 0.0,
    ) -> "WalkableGrid":
        """A flat floor with exactly these standable cells."""
        heights = np.where(standable, np.float32(floor_z), np.float32(np.nan))
        components = _by_size(*label_components(heights, math.inf))
        return WalkableGrid(standable, heights, components, cell_m, origin, floor_z)

    def cell_of(self, x: float, y: float) -> tuple[int, int]:
        """The ``(row, column)`` that holds a point; may lie outside the grid."""
        return (
            math.floor((y - self.origin[1]) / self.cell_m),
            math.floor((x - self.origin[0]) / self.cell_m),
        )

    def component_of(self, x: float, y: float, z: float | None = None) -> int:
        """The connected part that a point lies in: 0 is the largest, -1 is not standable."""
        row, column = self.cell_of(x, y)
        if not has_cell(self.components.shape, row, column):
            return -1
        return int(self.components[row, column])

    def is_standable(self, x: float, y: float, z: float | None = None) -> bool:
        """Whether the robot fits here."""
        return self.component_of(x, y) >= 0

    def height_at(self, x: float, y: float, z: float | None = None) -> float:
        """Floor height at a standable point, metres; NaN elsewhere."""
        return float(self.heights[self.cell_of(x, y)]) if self.is_standable(x, y) else math.nan

    def is_on_storey(self, z: Float64[np.ndarray, "n"]) -> Bool[np.ndarray, "n"]:
        """Whether heights belong to this storey, whose floors differ by less than a metre."""
        return np.abs(z - self.floor_z) <= _STOREY_M

    def centres(self, component: int = 0) -> Float64[np.ndarray, "n 2"]:
        """Middle of every cell of one connected part, in order of rows."""
        cells = np.argwhere(self.components == component)
        return np.array(self.origin) + (cells[:, ::-1] + 0.5) * self.cell_m

    def area_m2(self, component: int = 0) -> float:
        """Area of one connected part."""
        return int((self.components == component).sum()) * self.cell_m**2

    def floor_near(
        self, low: Position, high: Position, reach_m: float
    ) -> Float64[np.ndarray, "n 3"]:
        """Middles of cells of the largest part, with their heights, around a box.

        There are none around a thing on another storey, which may be seen over a railing.
        """
        centres = self.centres()
        near = is_near_box(centres, low[:2], high[:2], reach_m)
        near &= self.holds_z[0] <= low[2] < self.holds_z[1]
        heights = self.heights[self.components == 0][near]
        return np.column_stack([centres[near], heights.astype(np.float64)])

    def nearest_standable(self, x: float, y: float, z: float | None = None) -> Position:
        """The middle of the cell of the largest part that is nearest to a point."""
        centres = self.centres()
        nearest = centres[np.argmin(((centres - (x, y)) ** 2).sum(axis=1))]
        return float(nearest[0]), float(nearest[1]), self.height_at(*nearest.tolist())

    def move(self, position: Position, dx: float, dy: float, *, sliding: bool = False) -> Position:
        """End of a straight move on the floor, as by `step`."""
        x, y = self.step(position[0], position[1], dx, dy, sliding)
        return x, y, self.height_at(x, y)

    def step(
        self, x: float, y: float, dx: float, dy: float, sliding: bool = False
    ) -> tuple[float, float]:
        """End of a straight move.

        Args:
            x: x of the start, metres.
            y: y of the start, metres.
            dx: Wanted displacement along x, metres.
            dy: Wanted displacement along y, metres.
            sliding: Whether to slide along obstacles; by default the robot stops at the contact.

        Returns:
            The target (or up to half a cell beside it if the robot grazed a corner), or the
            last standable point before the contact, or the point where the robot slid to. A robot
            off the floor doesn't move.
        """
        u, v = (x - self.origin[0]) / self.cell_m, (y - self.origin[1]) / self.cell_m
        du, dv = dx / self.cell_m, dy / self.cell_m
        end_u, end_v, arrived = walk(self.standable, u, v, du, dv)
        if arrived and math.dist((end_u, end_v), (u + du, v + dv)) < _ROUNDING:
            return x + dx, y + dy
        if sliding and not arrived:
            end_u, end_v = slide(self.standable, u, v, du, dv)
        return (
            float(end_u * self.cell_m + self.origin[0]),
            float(end_v * self.cell_m + self.origin[1]),
        )

    def distance(self, start: tuple[float, float], end: tuple[float, float]) -> float:
        """Geodesic distance, metres; infinite if no path exists or a point is not standable."""
        return self.free_space.distance(start, end)

    def shortest_path(
        self, start: tuple[float, float], end: tuple[float, float]
    ) -> list[tuple[float, float]]:
        """Corners of the shortest path with both ends; its length is `distance`. Empty if none."""
        return self.free_space.shortest_path(start, end)

    def goal_field(self, goals: Float64[np.ndarray, "n 3"]) -> DistanceField:
        """As `distance_field`, for those of the positions in space that are on this storey."""
        here = goals[self.is_on_storey(goals[:, 2])]
        return self.distance_field(np.ascontiguousarray(here[:, :2]))

    def distance_field(self, targets: Float64[np.ndarray, "n 2"]) -> DistanceField:
        """Geodesic distance from anywhere to the nearest of many points."""
        return self.free_space.distance_field(targets)

    @cached_property
    def free_space(self) -> FreeSpace:
        """The standable cells as a space of shortest paths."""
        return FreeSpace.of(self.standable, self.cell_m, self.origin)

    def random_point(self, rng: np.random.Generator) -> tuple[float, float]:
        """A point of the largest connected part, uniform over its area."""
        cells = np.flatnonzero(self.components == 0)
        if cells.size == 0:
            raise StartError("the grid has no standable cell to draw a point from")
        row, column = divmod(int(cells[rng.integers(cells.size)]), self.components.shape[1])
        u, v = rng.uniform(0.001, 0.999, size=2)
        return (
            float(self.origin[0] + (column + u) * self.cell_m),
            float(self.origin[1] + (row + v) * self.cell_m),
        )


def _by_size(
    labels: Int32[np.ndarray, "rows columns"], sizes: np.ndarray
) -> Int32[np.ndarray, "rows columns"]:
    """Renumber parts by size, the largest as 0; -1 is kept."""
    rank = np.empty(sizes.size + 1, dtype=np.int32)
    rank[np.argsort(-sizes, kind="stable")] = np.arange(sizes.size, dtype=np.int32)
    rank[-1] = -1
    return rank[labels]


def _grid_of(storey: Storey, robot: BodyConfig) -> WalkableGrid:
    """Number the parts of a storey and drop what is no floor: tabletops, insides of furniture."""
    components = storey.labels.copy()
    floor_z = float(np.median(storey.heights[components == 0]))
    cells = np.bincount(components[components >= 0])
    kept = 1
    for part in range(1, cells.size):
        height = float(np.median(storey.heights[components == part]))
        is_floor = abs(height - floor_z) <= robot.max_step_m
        if is_floor and cells[part] * storey.cell_m**2 >= _SMALLEST_ISLAND_M2:
            components[components == part] = kept
            kept += 1
        else:
            components[components == part] = -1
    standable = components >= 0
    if not standable.any():
        raise SceneError("the robot fits nowhere in this scene")
    heights = np.where(standable, storey.heights, np.float32(np.nan))
    return WalkableGrid(standable, heights, components, storey.cell_m, storey.origin, floor_z)
