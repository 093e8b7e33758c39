"""Detection of collisions with obstacles that the map does not show."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float64

from hypernav.core.embodiment import Action, Embodiment, MotionConfig
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2, distances_to_segment
from hypernav.search.mapping.inflation import inflate
from hypernav.search.planning.config import PlanningConfig

_MOVED_SHARE = 0.6
"""Share of the ordered length below which a step counts as cut short by a collision."""
_TOUCHES_M = 0.1
"""Length, metres, by which an obstacle that the robot touches may be larger than seen."""
_LATEST = 50
"""Number of latest positions whose track counts as free: things may have come onto older ones."""


def is_cut_short(ordered: tuple[Pose2, Action] | None, robot: Pose2, motion: MotionConfig) -> bool:
    """Whether the robot bumped into something: the latest action was a step that it did not finish.

    Args:
        ordered: Pose before the latest action, and that action; None before the first.
        robot: Pose of the robot.
        motion: Length of a step.
    """
    if ordered is None or ordered[1] is not Action.MOVE_FORWARD:
        return False
    return ordered[0].distance_to(*robot.xy) < _MOVED_SHARE * motion.forward_m


def bumped_points(
    ordered: tuple[Pose2, Action] | None,
    robot: Pose2,
    track: Sequence[tuple[float, float]],
    grid: OccupancyGrid,
    config: PlanningConfig,
    embodiment: Embodiment,
) -> Float64[np.ndarray, "n 2"]:
    """Points where something unseen must be, if a step forward was cut short.

    If the map shows obstacles beside the robot's front, the robot has touched one of them that
    is a little larger than it was seen; else something unseen is right before it. It is not where
    the robot's body has just been: the track that it came by leads out again.

    Args:
        ordered: Pose before the latest action, and that action; None before the first.
        robot: Pose of the robot.
        track: Its positions ``(x, y)`` in this search, metres.
        grid: The map.
        config: Whether to detect collisions, and the margin between the robot and obstacles.
        embodiment: Length of a step and size of the robot.

    Returns:
        Points ``(x, y)`` at the robot's front, ``map`` frame, metres; none if it moved as ordered.
    """
    if not (config.bump_sensor and is_cut_short(ordered, robot, embodiment.motion)):
        return np.zeros((0, 2))
    angles = robot.yaw + np.radians(np.arange(-60.0, 61.0, 10.0))
    clearance_m = config.clearances_m(embodiment.body)[0]
    front = np.array(robot.xy) + clearance_m * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    beside_known = inflate(grid.occupied, _TOUCHES_M, grid.resolution_m) > 0
    cells = grid.cells_of(front)
    inside = grid.contains(cells)
    touched = np.zeros(len(front), dtype=bool)
    touched[inside] = beside_known[cells[inside, 0], cells[inside, 1]]
    ahead = np.zeros(len(front), dtype=bool)
    ahead[3:-3] = True
    free = _swept(front, track[-_LATEST:], embodiment)
    for points in (touched & ~free, ahead & ~free):
        if points.any():
            return front[points]
    return front[ahead]  # something has come into the way since


def _swept(
    points: Float64[np.ndarray, "n 2"],
    track: Sequence[tuple[float, float]],
    embodiment: Embodiment,
) -> Bool[np.ndarray, " n"]:
    """Whether the robot's body has passed over points."""
    swept = np.zeros(len(points), dtype=bool)
    for start, end in pairwise(np.array(track)):
        if math.dist(start, end) > 1.5 * embodiment.motion.forward_m:
            continue  # it was carried
        swept |= distances_to_segment(points, start, end) < embodiment.body.radius_m
    return swept
