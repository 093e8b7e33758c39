"""Where an episode begins, and how hard that makes it."""

import math
from dataclasses import dataclass

import numpy as np

from hypernav.core.geometry.transforms import Pose2
from hypernav.houses.dice import Dice
from hypernav.houses.episodes.site import Site
from hypernav.worlds.surface.goal_regions import GoalRegion

NEAREST_M = 2.0
FARTHEST_M = 30.0
"""Least and greatest geodesic distance of a start to its goal."""

_DRAWS = 60
_STRAIGHT_RATIO = 1.05
_STRAIGHT_KEPT = 0.2
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


def draw_start(dice: Dice, site: Site, region: GoalRegion) -> Start | None:
    """A start from which a goal is 2 to 30 m away, with a roomy way there; None if none turns up.

    Two are drawn and the farther one is taken: uniform starts in small homes are mostly near.

    Args:
        dice: Chance.
        site: The house.
        region: Of the goal.
    """
    if not site.has_roomy(region.view_points):
        return None
    found: list[tuple[float, float, float]] = []
    straight: list[tuple[float, float, float]] = []
    for _ in range(_DRAWS):
        x, y = _draw_point(dice, site)
        geodesic_m = region.distance(x, y)
        if not NEAREST_M <= geodesic_m <= FARTHEST_M:
            continue
        is_straight = geodesic_m < _STRAIGHT_RATIO * _straight_m(region, x, y)
        rejected = is_straight and not dice.chance(_STRAIGHT_KEPT)
        (straight if rejected else found).append((geodesic_m, x, y))
        if len(found) == 2:
            break
    if not found and not straight:
        return None
    geodesic_m, x, y = max(found or straight)
    # Rounded as the file holds it, so that angles are the same on every machine.
    yaw = round(dice.uniform(-math.pi, math.pi), 4)
    path = region.field.path(x, y)
    return Start(
        Pose2(x, y, yaw),
        site.walkable.height_at(x, y),
        geodesic_m,
        # Geodesic distances are measured on a lattice and may be a millimetre short.
        min(_straight_m(region, x, y), geodesic_m),
        site.rooms_on(path),
        path[-1],
    )


def _draw_point(dice: Dice, site: Site) -> tuple[float, float]:
    """A point well inside a cell of the largest roomy part, whole millimetres."""
    cell = site.centres[dice.integer(0, len(site.centres) - 1)]
    reach = 0.4 * site.walkable.cell_m
    x, y = (round(float(middle) + dice.uniform(-reach, reach), 3) for middle in cell)
    return x, y


def _straight_m(region: GoalRegion, x: float, y: float) -> float:
    gaps = region.view_points[:, :2] - (x, y)
    return float(np.sqrt((gaps**2).sum(axis=1).min()))
