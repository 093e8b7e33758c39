"""Start poses of episodes, with their distances to the goal."""

import math
from dataclasses import dataclass

import numpy as np

from hypernav.core.geometry.transforms import Pose2
from hypernav.houses.episodes.ground_truth import HouseGroundTruth
from hypernav.houses.episodes.rules import EpisodeRules
from hypernav.houses.random_stream import RandomStream
from hypernav.worlds.surface.goal_regions import GoalRegion

_START_SAMPLES = 60
_STRAIGHT_RATIO = 1.05
_STRAIGHT_KEPT_SHARE = 0.2
"""Share that is kept of starts with a straight path to the goal, as in Habitat's generator."""


@dataclass(frozen=True)
class Start:
    """Start pose and its shortest path to the goal.

    Attributes:
        pose: Start pose, scene frame.
        floor_z: Height of the floor at the start, metres.
        geodesic_m: Length of the shortest path to a view point, metres.
        euclidean_m: Straight distance to the nearest view point, metres.
        rooms: Number of rooms on the shortest path, the first one included; 0 if unknown.
        end: End of the shortest path, metres, scene frame.
        goal_is: Where the goal is from there in a building with several storeys: on the "same"
            storey, "above" or "below".
    """

    pose: Pose2
    floor_z: float
    geodesic_m: float
    euclidean_m: float
    rooms: int
    end: tuple[float, float]
    goal_is: str | None = None


def sample_start(
    rng: RandomStream, truth: HouseGroundTruth, region: GoalRegion, rules: EpisodeRules
) -> Start | None:
    """Random start at a distance from a goal that the rules allow; None if none is found.

    A wide path leads from the start to the goal. The farther of two samples is taken, because
    uniform starts in small homes are mostly near.

    Args:
        rng: Source of randomness.
        truth: Ground truth of the building.
        region: Region of the goal.
        rules: Rules of the episodes.
    """
    if not truth.touches_wide_area(region.view_points):
        return None
    found: list[tuple[float, float, float]] = []
    straight: list[tuple[float, float, float]] = []
    for _ in range(_START_SAMPLES):
        x, y = _sample_point(rng, truth)
        geodesic_m = region.distance(x, y)
        if not rules.least_m <= geodesic_m <= rules.most_m:
            continue
        is_straight = geodesic_m < _STRAIGHT_RATIO * _euclidean_m(region, x, y)
        rejected = is_straight and not rng.chance(_STRAIGHT_KEPT_SHARE)
        (straight if rejected else found).append((geodesic_m, x, y))
        if len(found) == 2:
            break
    if not found and not straight:
        return None
    geodesic_m, x, y = max(found or straight)
    # Rounded as in the file, so that angles are the same on every machine.
    yaw = round(rng.uniform(-math.pi, math.pi), 4)
    path = region.field.path(x, y)
    return Start(
        Pose2(x, y, yaw),
        truth.walkable.height_at(x, y),
        geodesic_m,
        # Geodesic distances are measured on a lattice and may be a millimetre short.
        min(_euclidean_m(region, x, y), geodesic_m),
        truth.rooms_on(path),
        path[-1],
    )


def _sample_point(rng: RandomStream, truth: HouseGroundTruth) -> tuple[float, float]:
    """Random point well inside a cell of the wide area, in whole millimetres."""
    cell = truth.start_centres[rng.integer(0, len(truth.start_centres) - 1)]
    reach = 0.4 * truth.walkable.cell_m
    x, y = (round(float(middle) + rng.uniform(-reach, reach), 3) for middle in cell)
    return x, y


def _euclidean_m(region: GoalRegion, x: float, y: float) -> float:
    gaps = region.view_points[:, :2] - (x, y)
    return float(np.sqrt((gaps**2).sum(axis=1).min()))
