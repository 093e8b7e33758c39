"""Detection of collisions with obstacles that the map does not show."""

import numpy as np
from jaxtyping import Float64

from hypernav.core.actions import Action
from hypernav.core.embodiment import Embodiment
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.mapping.inflation import inflate
from hypernav.planning.config import PlanningConfig

_MOVED_SHARE = 0.6
"""Share of the ordered length below which a step counts as cut short by a collision."""
_TOUCHES_M = 0.1
"""Length, metres, by which an obstacle that the robot touches may be larger than seen."""


def bumped_points(
    ordered: tuple[Pose2, Action] | None,
    robot: Pose2,
    grid: OccupancyGrid,
    config: PlanningConfig,
    embodiment: Embodiment,
) -> Float64[np.ndarray, "n 2"]:
    """Points where something unseen must be, if a step forward was cut short.

    If the map shows obstacles beside the robot's front, the robot has touched one of them that
    is a little larger than it was seen; else something unseen is right before it.

    Args:
        ordered: Pose before the latest action, and that action; None before the first.
        robot: Pose of the robot.
        grid: The map.
        config: Whether to detect collisions, and the margin between the robot and obstacles.
        embodiment: Length of a step and size of the robot.

    Returns:
        Points ``(x, y)`` at the robot's front, ``map`` frame, metres; none if it moved as ordered.
    """
    if not config.bump_sensor or ordered is None or ordered[1] is not Action.MOVE_FORWARD:
        return np.zeros((0, 2))
    moved = ordered[0].distance_to(*robot.xy)
    if moved >= _MOVED_SHARE * embodiment.motion.forward_m:
        return np.zeros((0, 2))
    angles = robot.yaw + np.radians(np.arange(-60.0, 61.0, 10.0))
    clearance_m = config.clearances_m(embodiment.body)[0]
    front = np.array(robot.xy) + clearance_m * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    beside_known = inflate(grid.occupied, _TOUCHES_M, grid.resolution_m) > 0
    cells = grid.cells_of(front)
    inside = grid.contains(cells)
    touched = np.zeros(len(front), dtype=bool)
    touched[inside] = beside_known[cells[inside, 0], cells[inside, 1]]
    return front[touched] if touched.any() else front[3:-3]
