"""Finds the storeys of a building and their floors."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Int32

from hypernav.core.embodiment import BodyConfig
from hypernav.core.errors import SceneError
from hypernav.mapping.inflation import inflate
from hypernav.worlds.config import CELL_M
from hypernav.worlds.scenes.scene import Scene
from hypernav.worlds.surface.columns_kernels import floors_of_columns, rasterise
from hypernav.worlds.surface.walkable_kernels import label_components, mark_cliffs

_MOST_CELLS = 10_000_000
_MOST_INTERVALS = 20_000_000
_HIGHEST_M = 1000.0
_STOREYS_TRIED = 6


@dataclass(frozen=True, eq=False)
class Storey:
    """One storey's height map, without cells nearer to obstacles than the robot's radius.

    Attributes:
        heights: Floor height where the robot's centre may be, metres; NaN elsewhere.
        cell_m: Side of a cell.
        origin: Lower left corner of cell (0, 0), scene frame, metres.
    """

    heights: Float32[np.ndarray, "rows columns"]
    cell_m: float
    origin: tuple[float, float]


@dataclass(frozen=True, eq=False)
class _Floors:
    """Every floor to stand on, on all storeys: cell number and height."""

    cell: Int32[np.ndarray, "n"]
    z: Float32[np.ndarray, "n"]
    rows: int
    columns: int
    cell_m: float
    origin: tuple[float, float]


def find_storey(
    scene: Scene, robot: BodyConfig, *, cell_m: float = CELL_M, floor_z: float | None = None
) -> Storey:
    """The storey at a height, or the one with the largest connected floor.

    Roofs and the upper side of ceilings are not storeys, because nothing of the scene is far above
    them. They count only if the scene has nothing else to stand on.

    Raises:
        SceneError: There is none, or the scene is too large to be in metres.
    """
    floors = _floors(scene, robot, cell_m)
    # Two floors of one column are at least the robot's height apart, so this window holds one.
    window = min(0.5, robot.height_m / 2.0)
    if floor_z is not None:
        storey = _storey(floors, robot, floor_z, window)
        if np.isnan(storey.heights).all():
            raise SceneError(
                f"scene '{scene.name}': the robot (radius {robot.radius_m} m, height "
                f"{robot.height_m} m) fits nowhere on the storey at {floor_z:.2f} m; it could "
                f"stand at {_some_heights(floors)}"
            )
        return storey
    best, best_key = None, (False, 0)
    top = float(scene.vertices[:, 2].max())
    for height in _candidate_heights(floors, window):
        storey = _storey(floors, robot, height, window)
        _, sizes = label_components(storey.heights, robot.max_step_m)
        if sizes.size and (key := (height + robot.height_m < top, int(sizes.max()))) > best_key:
            best, best_key = storey, key
    if best is None:
        raise SceneError(
            f"scene '{scene.name}': the robot (radius {robot.radius_m} m, height {robot.height_m} "
            f"m) fits nowhere; it could stand at {_some_heights(floors)}"
        )
    return best


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
    cell, z = floors_of_columns(
        upwards, where, low, high, flat, rows * columns, robot.max_step_m, robot.height_m
    )
    return _Floors(cell, z, rows, columns, cell_m, origin)


def _candidate_heights(floors: _Floors, window: float) -> list[float]:
    """Heights with the most cells, at least a window apart."""
    if floors.z.size == 0:
        return []
    bin_m = 0.05
    bins = np.floor(floors.z / bin_m).astype(np.int64)
    lowest = int(bins.min())
    counts = np.bincount(bins - lowest)
    reach = math.ceil(window / bin_m)
    heights: list[float] = []
    while len(heights) < _STOREYS_TRIED and counts.any():
        k = int(counts.argmax())
        inside = bins == k + lowest
        heights.append(float(np.median(floors.z[inside])))
        counts[max(k - reach, 0) : k + reach + 1] = 0
    return heights


def _storey(floors: _Floors, robot: BodyConfig, floor_z: float, window: float) -> Storey:
    """The height map around a height, without cells too close to an obstacle, drop or edge."""
    heights = np.full(floors.rows * floors.columns, np.nan, dtype=np.float32)
    near = np.abs(floors.z - floor_z) < window
    heights[floors.cell[near]] = floors.z[near]
    heights = heights.reshape(floors.rows, floors.columns)
    obstacle = np.isnan(heights) | mark_cliffs(heights, robot.max_step_m)
    # A cell whose distance equals the robot's radius is far enough.
    heights[inflate(obstacle, robot.radius_m - 1e-6, floors.cell_m) > 0] = np.nan
    return Storey(heights, floors.cell_m, floors.origin)


def _some_heights(floors: _Floors) -> str:
    heights = sorted(_candidate_heights(floors, 0.5))
    return ", ".join(f"{z:.2f}" for z in heights) + " m" if heights else "no height at all"
