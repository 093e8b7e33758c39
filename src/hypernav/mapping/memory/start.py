"""Whether a robot stands where its memory says, by what it sees at the start of a search."""

from pathlib import Path

import numpy as np
from jaxtyping import Float64

from hypernav.core.errors import MemoryStartError
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.observation import Observation
from hypernav.mapping.inflation import inflate
from hypernav.mapping.memory.floor import counted_from
from hypernav.mapping.memory.memory import Memory
from hypernav.mapping.sight_lines import lines_are_clear
from hypernav.mapping.top_down.top_down_map import TopDownMap

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


def check_start(
    memory: Memory, observation: Observation, folder: Path, *, trusts_height: bool
) -> None:
    """Refuse a start that contradicts the map.

    A robot may begin where nothing is known, on a new floor too. But if what it sees there is what
    a known floor has at that position, then more likely the heights of its poses are wrong.

    Args:
        memory: The memory; it is not changed.
        observation: First frame, in its ``map`` frame.
        folder: Its folder, for the message.
        trusts_height: Whether the height is right, as in simulation. Many buildings have walls
            above walls: in three generated ones 66 % of 400 images fitted another floor, too.

    Raises:
        MemoryStartError: What the robot sees is not what the map shows there.
    """
    z = memory.height_of(observation)
    number = memory.number_at(z)
    seen = counted_from(z, observation)
    fit = None if number is None else fit_of(memory.floors[number].map, seen)
    x, y = observation.robot.xy
    if fit is not None and fit < _LEAST_FIT:
        raise MemoryStartError(
            f"what the robot sees at ({x:.1f}, {y:.1f}) is not what {folder} remembers there: "
            f"{fit:.0%} of it fits the map, at least {_LEAST_FIT:.0%} must; check that this is the "
            "same building and that poses are in the memory's map frame, or name another folder"
        )
    for floor in memory.floors if number is None and not trusts_height else ():
        fit = fit_of(floor.map, seen)
        if fit is not None and fit >= _LEAST_FIT:
            raise MemoryStartError(
                f"the robot's pose is {z:.1f} m high, where {folder} knows no floor, and {fit:.0%} "
                f"of what it sees at ({x:.1f}, {y:.1f}) fits the floor at {floor.z:.1f} m; check "
                "that heights are in the memory's map frame. If the robot really is on another "
                "floor, begin where that looks different, or name another folder"
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
