"""Distance from a robot to the surface of an object, seen from above."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float64

from hypernav.core.world import HasSurfaces, Instance, Position

BELOW_M = 0.5
"""How far an object may end below the robot's floor and still be on its storey, metres."""
ABOVE_M = 2.5
"""How far above the robot's floor an object may begin and still be on its storey, metres."""


def object_distance(scene: HasSurfaces, goals: Sequence[Instance], robot: Position) -> float | None:
    """Distance in the plane from the robot's middle to the nearest surface of a goal, metres.

    It is a straight line, through walls too, and 0 if the robot is below or inside a part of the
    object. Objects of other storeys don't count.

    Args:
        scene: The scene.
        goals: Instances that satisfy the goal.
        robot: Position of the robot on its floor, scene frame, metres.

    Returns:
        The distance; None if no part of a goal is on the robot's storey.
    """
    x, y, z = robot
    near = [
        goal.id for goal in goals if goal.box_min[2] < z + ABOVE_M and goal.box_max[2] > z - BELOW_M
    ]
    triangles = scene.triangles_of(near)
    return float(_distances(triangles[:, :, :2] - (x, y)).min()) if len(triangles) else None


def _distances(triangles: Float64[np.ndarray, "n 3 2"]) -> Float64[np.ndarray, " n"]:
    """Distance of the origin from each triangle of the plane."""
    edges = np.roll(triangles, -1, axis=1) - triangles
    lengths = (edges**2).sum(axis=2)
    along = -(triangles * edges).sum(axis=2) / np.where(lengths > 0.0, lengths, 1.0)
    nearest = triangles + np.clip(along, 0.0, 1.0)[:, :, None] * edges
    away = np.sqrt((nearest**2).sum(axis=2)).min(axis=1)
    side = edges[:, :, 1] * triangles[:, :, 0] - edges[:, :, 0] * triangles[:, :, 1]
    inside = (side > 0.0).all(axis=1) | (side < 0.0).all(axis=1)
    return np.where(inside, 0.0, away)
