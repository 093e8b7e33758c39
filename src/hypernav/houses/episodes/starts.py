"""Where an episode begins, and how hard that makes it."""

import math
from dataclasses import dataclass

import numpy as np

from hypernav.core.geometry.transforms import Pose2
from hypernav.houses.episodes.ground_truth import HouseGroundTruth
from hypernav.houses.random_stream import RandomStream
from hypernav.worlds.surface.goal_regions import GoalRegion

MIN_GEODESIC_M = 2.0
MAX_GEODESIC_M = 30.0
"""Least and greatest geodesic distance of a start to its goal."""

_START_SAMPLES = 60
_STRAIGHT_RATIO = 1.05
_STRAIGHT_KEPT_SHARE = 0.2
"""As Habitat does it: of starts with a straight way to the goal only a fifth is kept."""


@dataclass(frozen=True)
class Start:
    """A start pose and its way to the goal.

    Attributes:
        pose: Scene frame.
        floor_z: Height of the floor there, metres.
        geodesic_m: Length of the shortest way to a view point.
        euclidean_m: Straight to the nearest view point.
        rooms: Rooms that the shortest way touches, that of the start included; 0 if unknown.
        end: Where the shortest way ends, metres, scene frame.
    """

    pose: Pose2
    floor_z: float
    geodesic_m: float
    euclidean_m: float
    rooms: int
    end: tuple[float, float]


def sample_start(rng: RandomStream, truth: HouseGroundTruth, region: GoalRegion) -> Start | None:
    """A start from which a goal is 2 to 30 m away, with a roomy way there; None if none turns up.

    Two are drawn and the farther one is taken: uniform starts in small homes are mostly near.

    Args:
        rng: Chance.
        truth: The house.
        region: Of the goal.
    """
    if not truth.touches_wide_area(region.view_points):
        return None
    found: list[tuple[float, float, float]] = []
    straight: list[tuple[float, float, float]] = []
    for _ in range(_START_SAMPLES):
        x, y = _sample_point(rng, truth)
        geodesic_m = region.distance(x, y)
        if not MIN_GEODESIC_M <= geodesic_m <= MAX_GEODESIC_M:
            continue
        is_straight = geodesic_m < _STRAIGHT_RATIO * _euclidean_m(region, x, y)
        rejected = is_straight and not rng.chance(_STRAIGHT_KEPT_SHARE)
        (straight if rejected else found).append((geodesic_m, x, y))
        if len(found) == 2:
            break
    if not found and not straight:
        return None
    geodesic_m, x, y = max(found or straight)
    # Rounded as the file holds it, so that angles are the same on every machine.
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
    """A point well inside a cell of the largest roomy part, whole millimetres."""
    cell = truth.start_centres[rng.integer(0, len(truth.start_centres) - 1)]
    reach = 0.4 * truth.walkable.cell_m
    x, y = (round(float(middle) + rng.uniform(-reach, reach), 3) for middle in cell)
    return x, y


def _euclidean_m(region: GoalRegion, x: float, y: float) -> float:
    gaps = region.view_points[:, :2] - (x, y)
    return float(np.sqrt((gaps**2).sum(axis=1).min()))
