"""Seeded random start poses."""

import math

import numpy as np

from hypernav.core.geometry.transforms import Pose2
from hypernav.worlds.surface.goal_regions import GoalRegion
from hypernav.worlds.surface.walkable_surface import WalkableSurface

_DRAWS = 2000


def random_start(
    walkable: WalkableSurface,
    rng: np.random.Generator,
    region: GoalRegion | None = None,
    *,
    nearest_m: float = 2.0,
    farthest_m: float = 30.0,
    z: float | None = None,
) -> Pose2:
    """A start pose from which a goal can be reached.

    Args:
        walkable: Where the robot can stand.
        rng: Random generator of the pose.
        region: Region of the goal; without one (or if no path leads to it) any start is possible.
        nearest_m: Smallest geodesic distance to the goal.
        farthest_m: Largest geodesic distance to the goal.
        z: Height of the floor that `walkable` draws from, metres; None means its main storey.

    Returns:
        A uniformly drawn pose of the largest connected part with a geodesic distance in the range;
        if none is found, the farthest pose that was drawn.

    Raises:
        StartError: The walkable surface is empty.
    """
    best, best_distance = walkable.random_point(rng), -math.inf
    if region is not None and region.is_reachable:
        for _ in range(_DRAWS):
            point = walkable.random_point(rng)
            distance = region.distance(*point, z)
            if nearest_m <= distance <= farthest_m:
                best = point
                break
            if math.isfinite(distance) and distance > best_distance:
                best, best_distance = point, distance
    return Pose2(*best, float(rng.uniform(-math.pi, math.pi)))
