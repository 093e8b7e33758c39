"""Positions that show a target from another side."""

import math

import numpy as np
from jaxtyping import Bool, Float64

from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.mapping.config import MappingConfig
from hypernav.mapping.memory.goal_area import GoalArea
from hypernav.mapping.reachable_area import ReachableArea

_OTHER_SIDE_DEG = 60.0
"""Smallest angle around the target between the first and the second position."""
_NEAREST_M, _FARTHEST_M = 1.5, 3.0
"""Distances to the target's middle at which all of it fits into the image, and is large in it."""
_APART_CELLS = 4
"""Spacing of the positions that are tried."""


def position_on_other_side(
    grid: OccupancyGrid,
    robot: Pose2,
    area: GoalArea,
    seen_from: tuple[float, float],
    mapping: MappingConfig,
    clearance_m: float,
) -> tuple[float, float] | None:
    """The nearest position that shows a goal area from another side.

    Args:
        grid: The map.
        robot: Pose of the robot.
        area: Goal area of the target.
        seen_from: Position ``(x, y)`` of the first look, metres.
        mapping: Configuration of the map.
        clearance_m: Distance from obstacles that the robot's middle keeps, metres.

    Returns:
        ``(x, y)``, metres; None if no such position can be reached.
    """
    reach = ReachableArea.of(grid, robot, mapping, clearance_m)
    cells = np.argwhere(reach.reachable)
    cells = cells[(cells % _APART_CELLS == 0).all(axis=1)]
    positions = reach.grid.centres_of(cells)
    away = positions - np.array(area.centre)
    distance = np.hypot(away[:, 0], away[:, 1])
    before = np.array(seen_from) - np.array(area.centre)
    cosine = away @ before / np.maximum(distance * np.hypot(*before), 1e-9)
    good = (distance >= _NEAREST_M) & (distance <= _FARTHEST_M)
    good &= cosine <= math.cos(math.radians(_OTHER_SIDE_DEG))
    good[good] = _in_sight(reach.grid, positions[good], area)
    if not good.any():
        return None
    travel_m = reach.travel_m[cells[:, 0], cells[:, 1]]
    x, y = positions[int(np.where(good, travel_m, np.inf).argmin())]
    return (float(x), float(y))


def _in_sight(
    grid: OccupancyGrid, positions: Float64[np.ndarray, "n 2"], area: GoalArea
) -> Bool[np.ndarray, "n"]:
    """Whether each position sees the middle of an area, hidden by nothing but the area itself."""
    hides = grid.occupied.copy()
    own = grid.cells_of(area.points)
    own = own[grid.contains(own)]
    hides[own[:, 0], own[:, 1]] = False
    steps = math.ceil(_FARTHEST_M / grid.resolution_m)
    share = np.linspace(0.0, 1.0, steps)[None, :, None]
    middle = np.array(area.centre)
    rays = grid.cells_of(
        (positions[:, None] + share * (middle - positions[:, None])).reshape(-1, 2)
    )
    known = grid.contains(rays)
    hidden = np.zeros(len(rays), dtype=bool)
    hidden[known] = hides[rays[known, 0], rays[known, 1]]
    return np.logical_not(hidden.reshape(len(positions), steps).any(axis=1))
