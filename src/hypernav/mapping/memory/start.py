"""Whether a robot stands where its memory says, by what it sees at the start of a search."""

from pathlib import Path

import numpy as np
from jaxtyping import Float64

from hypernav.core.errors import MemoryStartError
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.observation import Observation
from hypernav.mapping.inflation import inflate
from hypernav.mapping.sight_lines import lines_are_clear
from hypernav.mapping.top_down_map import TopDownMap

_STRIDE = 8
_LOWEST_M = 0.2
"""Height above the floor from which points are of what stands there, metres."""
_NEAR_M = 0.15
"""Distance from a remembered obstacle within which a point belongs to it, metres."""
_FAR_M = 0.35
"""Distance from all remembered obstacles beyond which a point contradicts the map, metres."""
_LEAST_SHARE = 0.08
"""Share of the sampled pixels that must tell something about the known map."""
_LEAST_FIT = 0.6
"""Share of the points that must agree with the map. In three training houses all of 117 images had
0.86 or more where they were taken, and 83 % of 296 had less than this elsewhere in the house."""


def check_start(map_: TopDownMap, observation: Observation, folder: Path) -> None:
    """Refuse a start that contradicts the map.

    Args:
        map_: Map of the floor that the robot is on.
        observation: First frame, with heights counted from that floor.
        folder: Folder of the memory, for the message.

    Raises:
        MemoryStartError: What the robot sees is not what the map shows there.
    """
    fit = fit_of(map_, observation)
    if fit is not None and fit < _LEAST_FIT:
        x, y = observation.robot.xy
        raise MemoryStartError(
            f"what the robot sees at ({x:.1f}, {y:.1f}) is not what {folder} remembers there: "
            f"{fit:.0%} of it fits the map, at least {_LEAST_FIT:.0%} must; check that this is the "
            "same building and that poses are in the memory's map frame, or name another folder"
        )


def fit_of(map_: TopDownMap, observation: Observation) -> float | None:
    """Share of what a frame shows that agrees with the map, 0 to 1.

    Points near remembered obstacles agree; points on remembered free floor don't, nor do those that
    lie behind remembered walls.

    Returns:
        None where too little of it lies on the known map to tell.
    """
    points = _points(map_, observation)
    grid = map_.grid
    cells = grid.cells_of(points)
    inside = grid.contains(cells)
    points, (rows, columns) = points[inside], cells[inside].T
    occupied, size = grid.occupied, grid.resolution_m
    is_near = inflate(occupied, _NEAR_M, size)[rows, columns] > 0
    is_far = inflate(occupied, _FAR_M, size)[rows, columns] == 0
    is_free = grid.cells[rows, columns] == Cell.FREE
    camera = observation.camera_to_map.translation[:2]
    is_behind = ~_in_sight(map_, grid, camera, points)
    agree = int((is_near & ~is_behind).sum())
    disagree = int(((is_far & is_free) | is_behind).sum())
    sampled = observation.depth[::_STRIDE, ::_STRIDE].size
    if agree + disagree < _LEAST_SHARE * sampled:
        return None
    return agree / (agree + disagree)


def _points(map_: TopDownMap, observation: Observation) -> Float64[np.ndarray, "n 2"]:
    """Points of obstacles in a frame, ``(x, y)``, metres."""
    sensor = map_.embodiment.camera
    depth = observation.depth[::_STRIDE, ::_STRIDE]
    rows, columns = np.nonzero(is_measured(depth, sensor.min_depth_m, sensor.max_depth_m))
    points = observation.points_at(rows * _STRIDE, columns * _STRIDE)
    z = points[:, 2]
    return points[(z > _LOWEST_M) & (z < map_.embodiment.body.height_m), :2]


def _in_sight(
    map_: TopDownMap,
    grid: OccupancyGrid,
    camera: Float64[np.ndarray, "2"],
    points: Float64[np.ndarray, "n 2"],
) -> np.ndarray:
    """Which points have no remembered wall before them."""
    if not len(points):
        return np.zeros(0, dtype=bool)
    away = points - camera
    distance = np.linalg.norm(away, axis=1, keepdims=True)
    ends = camera + away * np.maximum(1.0 - _FAR_M / np.maximum(distance, 1e-6), 0.0)
    starts = np.broadcast_to(camera, ends.shape).copy()
    walls = map_.eye_level(np.concatenate([points, camera[None]]))
    return lines_are_clear(walls, starts, ends, through=np.empty((0, 2)))
