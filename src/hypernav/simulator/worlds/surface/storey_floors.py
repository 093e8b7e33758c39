"""Finds the storeys of a building and their floors."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int32

from hypernav.core.embodiment import BodyConfig
from hypernav.core.errors import SceneError
from hypernav.core.world import Instance
from hypernav.search.mapping.inflation import inflate
from hypernav.simulator.worlds.config import CELL_M
from hypernav.simulator.worlds.scenes.scene import Scene
from hypernav.simulator.worlds.surface.walkable_kernels import (
    floors_of_columns,
    label_components,
    mark_cliffs,
    rasterise,
)
from hypernav.simulator.worlds.surface.walkable_surface import (
    BESIDE_M,
    FloorPart,
    by_importance,
    is_lived_on,
    stands_at,
    things_on,
)

_MOST_CELLS = 10_000_000
_MOST_INTERVALS = 20_000_000
_HIGHEST_M = 1000.0
_STOREYS_TRIED = 6
_MOST_STOREYS = 12
_APART_M = 1.0
"""Least height between two storeys."""
_SMALLEST_STOREY_M2 = 4.0
_SAME_FLOOR_M = 0.5


@dataclass(frozen=True, eq=False)
class Storey:
    """One storey's height map, without cells nearer to obstacles than the robot's radius.

    Attributes:
        heights: Floor height where the robot's centre may be, metres; NaN elsewhere.
        labels: Connected part of every cell: 0 is the main one, the others follow by size; -1 is
            none.
        parts: The parts, in the order of their numbers.
        cell_m: Side of a cell.
        origin: Lower left corner of cell (0, 0), scene frame, metres.
    """

    heights: Float32[np.ndarray, "rows columns"]
    labels: Int32[np.ndarray, "rows columns"]
    parts: tuple[FloorPart, ...]
    cell_m: float
    origin: tuple[float, float]


@dataclass(frozen=True, eq=False)
class _Floors:
    """Every floor to stand on, on all storeys: cell number, height, whether it is covered."""

    cell: Int32[np.ndarray, "n"]
    z: Float32[np.ndarray, "n"]
    covered: Bool[np.ndarray, "n"]
    rows: int
    columns: int
    cell_m: float
    origin: tuple[float, float]


def find_storey(
    scene: Scene, robot: BodyConfig, *, cell_m: float = CELL_M, floor_z: float | None = None
) -> Storey:
    """The storey at a height, or the main one, `by_importance`.

    Raises:
        SceneError: There is none, or the scene is too large to be in metres.
    """
    floors = _floors(scene, robot, cell_m)
    if floor_z is not None:
        storey = _storey(scene, floors, robot, floor_z)
        if np.isnan(storey.heights).all():
            raise SceneError(
                f"scene '{scene.name}': the robot (radius {robot.radius_m} m, height "
                f"{robot.height_m} m) fits nowhere on the storey at {floor_z:.2f} m; it could "
                f"stand at {_some_heights(floors)}"
            )
        return storey
    storeys = _storeys(scene, floors, robot, _STOREYS_TRIED)
    if not storeys:
        raise SceneError(
            f"scene '{scene.name}': the robot (radius {robot.radius_m} m, height {robot.height_m} "
            f"m) fits nowhere; it could stand at {_some_heights(floors)}"
        )
    return storeys[by_importance([one.parts[0] for one in storeys])[0]]


@dataclass(frozen=True, eq=False)
class Storeys:
    """The storeys of a building, and what tells its floors from its roofs.

    Attributes:
        heights: Heights of their floors, from the lowest on, metres.
    """

    heights: tuple[float, ...]
    _floors: _Floors
    _instances: tuple[Instance, ...]
    _highest_m: float

    @staticmethod
    def of(scene: Scene, robot: BodyConfig) -> "Storeys":
        """The storeys that the scene names, or else those found in its triangles.

        Found are floors of 4 m² and more, 1 m and more apart, that `is_lived_on`.
        """
        floors = _floors(scene, robot, CELL_M)
        highest_m = float(scene.vertices[:, 2].max()) - robot.height_m
        heights = scene.storeys or _heights_found(scene, floors, robot)
        return Storeys(heights, floors, scene.instances, highest_m)

    def part(self, points: Float64[np.ndarray, "n 3"], area_m2: float) -> FloorPart:
        """What tells whether a floor of these points, scene frame, metres, is the main one."""
        z = float(np.median(points[:, 2])) if len(points) else math.inf
        covered = float(self._is_covered(points).mean()) if len(points) else 0.0
        return FloorPart(things_on(points, self._instances), covered, z < self._highest_m, area_m2)

    def _is_covered(self, points: Float64[np.ndarray, "n 3"]) -> Bool[np.ndarray, " n"]:
        """Whether something is overhead."""
        floors = self._floors
        column, row = np.floor((points[:, :2] - floors.origin) / floors.cell_m).astype(int).T
        cell = row * floors.columns + column
        first, end = np.searchsorted(floors.cell, cell), np.searchsorted(floors.cell, cell, "right")
        covered, nearest = np.zeros(len(points), bool), np.full(len(points), _SAME_FLOOR_M)
        for k in range(int((end - first).max(initial=0))):
            here = np.flatnonzero(first + k < end)
            gap = np.abs(floors.z[first[here] + k] - points[here, 2])
            nearer = gap < nearest[here]
            covered[here[nearer]] = floors.covered[first[here[nearer]] + k]
            nearest[here[nearer]] = gap[nearer]
        return covered


def _heights_found(scene: Scene, floors: _Floors, robot: BodyConfig) -> tuple[float, ...]:
    storeys = _storeys(scene, floors, robot, _MOST_STOREYS)
    most = max((storey.parts[0].things for storey in storeys), default=0)
    heights: list[float] = []
    for storey in storeys:
        z = float(np.median(storey.heights[storey.labels == 0]))
        large = storey.parts[0].area_m2 >= _SMALLEST_STOREY_M2
        apart = all(abs(z - other) >= _APART_M for other in heights)
        if large and apart and is_lived_on(storey.parts[0], most):
            heights.append(z)
    return tuple(sorted(heights))


def _floors(scene: Scene, robot: BodyConfig, cell_m: float) -> _Floors:
    vertices = scene.vertices.astype(np.float64)
    low, high = vertices[:, :2].min(axis=0), vertices[:, :2].max(axis=0)
    # Cell borders at multiples of the cell's side, and a free margin all around.
    first = np.floor(low / cell_m) - 2
    columns, rows = (int(n) for n in np.ceil(high / cell_m) + 2 - first)
    if not rows * columns <= _MOST_CELLS:
        raise SceneError(
            f"scene '{scene.name}' spans {high[0] - low[0]:.0f} × {high[1] - low[1]:.0f} m, too "
            "large for a building; are its units metres?"
        )
    lowest, highest = float(vertices[:, 2].min()), float(vertices[:, 2].max())
    if highest - lowest > _HIGHEST_M:
        raise SceneError(
            f"scene '{scene.name}' is {highest - lowest:.0f} m high, too high for a building; are "
            "its units metres?"
        )
    origin = (float(first[0] * cell_m), float(first[1] * cell_m))
    where, low, high, flat = rasterise(
        vertices,
        scene.faces,
        cell_m,
        *origin,
        rows,
        columns,
        math.cos(math.radians(robot.max_slope_deg)) - 1e-6,
        _MOST_INTERVALS,
    )
    if len(where) >= _MOST_INTERVALS:
        raise SceneError(
            f"scene '{scene.name}': its triangles cover more than {_MOST_INTERVALS:,} cells of "
            f"{cell_m:g} m, too many for a building; are its units metres?"
        )
    # 16-bit keys make numpy's stable sort a fast radix sort; buildings span less than 65 m.
    upwards = np.argsort(
        np.clip((low - lowest) * 1000.0, 0, 65535).astype(np.uint16), kind="stable"
    )
    cell, z, covered = floors_of_columns(
        upwards, where, low, high, flat, rows * columns, robot.max_step_m, robot.height_m
    )
    return _Floors(cell, z, covered, rows, columns, cell_m, origin)


def _storeys(scene: Scene, floors: _Floors, robot: BodyConfig, most: int) -> list[Storey]:
    """Storeys at the heights with the most cells, where the robot fits."""
    heights = _candidate_heights(floors, _window(robot), most)
    storeys = (_storey(scene, floors, robot, height) for height in heights)
    return [storey for storey in storeys if storey.parts]


def _window(robot: BodyConfig) -> float:
    """How far floors of one storey differ from its height, metres.

    Two floors of one column are at least the robot's height apart, so this window holds one.
    """
    return min(0.5, robot.height_m / 2.0)


def _candidate_heights(floors: _Floors, window: float, most: int) -> list[float]:
    """Heights with the most cells, at least a window apart."""
    if floors.z.size == 0:
        return []
    bin_m = 0.05
    bins = np.floor(floors.z / bin_m).astype(np.int64)
    lowest = int(bins.min())
    counts = np.bincount(bins - lowest)
    reach = math.ceil(window / bin_m)
    heights: list[float] = []
    while len(heights) < most and counts.any():
        k = int(counts.argmax())
        inside = bins == k + lowest
        heights.append(float(np.median(floors.z[inside])))
        counts[max(k - reach, 0) : k + reach + 1] = 0
    return heights


def _storey(scene: Scene, floors: _Floors, robot: BodyConfig, floor_z: float) -> Storey:
    """The height map around a height, without cells too close to an obstacle, drop or edge."""
    heights = np.full(floors.rows * floors.columns, np.nan, dtype=np.float32)
    covered = np.zeros(heights.size, dtype=bool)
    near = np.abs(floors.z - floor_z) < _window(robot)
    heights[floors.cell[near]] = floors.z[near]
    covered[floors.cell[near]] = floors.covered[near]
    heights = heights.reshape(floors.rows, floors.columns)
    obstacle = np.isnan(heights) | mark_cliffs(heights, robot.max_step_m)
    # A cell whose distance equals the robot's radius is far enough.
    heights[inflate(obstacle, robot.radius_m - 1e-6, floors.cell_m) > 0] = np.nan
    labels, sizes = label_components(heights, robot.max_step_m)
    things = _things_on(scene.instances, labels, heights, sizes.size, floors)
    here = labels.ravel() >= 0
    roofed = np.bincount(labels.ravel()[here], covered[here], sizes.size) / np.maximum(sizes, 1)
    top = floor_z + robot.height_m < float(scene.vertices[:, 2].max())
    parts = [
        FloorPart(int(things[k]), float(roofed[k]), top, float(sizes[k]) * floors.cell_m**2)
        for k in range(sizes.size)
    ]
    order = np.argsort(-sizes, kind="stable").tolist()
    if parts:
        main = by_importance([parts[k] for k in order])[0]
        order.insert(0, order.pop(main))
    rank = np.full(sizes.size + 1, -1, dtype=np.int32)  # the last one is that of -1
    rank[order] = np.arange(sizes.size, dtype=np.int32)
    ordered = tuple(parts[k] for k in order)
    return Storey(heights, rank[labels], ordered, floors.cell_m, floors.origin)


def _things_on(
    instances: tuple[Instance, ...],
    labels: Int32[np.ndarray, "rows columns"],
    heights: Float32[np.ndarray, "rows columns"],
    count: int,
    floors: _Floors,
) -> Int32[np.ndarray, " parts"]:
    """Number of labelled things that stand on each part of a storey."""
    things = np.zeros(count, dtype=np.int32)
    for one in instances:
        if one.label is None:
            continue
        low = (np.array(one.box_min[:2]) - BESIDE_M - floors.origin) / floors.cell_m
        high = (np.array(one.box_max[:2]) + BESIDE_M - floors.origin) / floors.cell_m
        (x, y), (x_end, y_end) = np.maximum(np.floor([low, high]), 0).astype(int)
        around = slice(y, y_end + 1), slice(x, x_end + 1)
        fits = (labels[around] >= 0) & stands_at(one, heights[around])
        things[np.unique(labels[around][fits])] += 1
    return things


def _some_heights(floors: _Floors) -> str:
    heights = sorted(_candidate_heights(floors, 0.5, _STOREYS_TRIED))
    return ", ".join(f"{z:.2f}" for z in heights) + " m" if heights else "no height at all"
