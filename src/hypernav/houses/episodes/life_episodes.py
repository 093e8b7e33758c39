"""Lives in a building: several goals, one after the other, each from where the last one is.

They are generated for a robot that makes no mistake: every goal's start is the end of the shortest
path to the one before. A real robot stands elsewhere, so every goal can be reached from everywhere.
"""

import math
from collections.abc import Iterator
from itertools import chain, islice

import numpy as np

from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.world import Position
from hypernav.houses.episodes.ground_truth import HouseGroundTruth
from hypernav.houses.episodes.queries import Query, category_queries, phrase_queries
from hypernav.houses.episodes.rules import EpisodeRules
from hypernav.houses.episodes.starts import Start
from hypernav.houses.episodes.storey_starts import StoreyTruth
from hypernav.houses.random_stream import RandomStream
from hypernav.worlds.surface.goal_regions import GoalRegion

LIVES_PER_BUILDING = 4
GOALS_OF_A_LIFE = (5, 10)
"""Least and greatest number of goals of a life."""

_MOST_QUERIES = 150
_MOST_TRIES = 20

LifeGoals = list[tuple[Query, Start]]


def draw_lives(
    rng: RandomStream, truth: HouseGroundTruth | StoreyTruth, rules: EpisodeRules
) -> list[LifeGoals]:
    """The lives of a building: goals of different categories, every other one a phrase.

    Args:
        rng: Source of randomness.
        truth: Ground truth of the building.
        rules: Goals, and their least and greatest distance from the goal before.
    """
    regions: dict[str, GoalRegion] = {}
    tries = (
        _draw_life(rng.fork("life", number), truth, rules, regions) for number in range(_MOST_TRIES)
    )
    whole = (life for life in tries if len(life) >= GOALS_OF_A_LIFE[0])
    return list(islice(whole, LIVES_PER_BUILDING))


def _draw_life(
    rng: RandomStream,
    truth: HouseGroundTruth | StoreyTruth,
    rules: EpisodeRules,
    regions: dict[str, GoalRegion],
) -> LifeGoals:
    wanted = rng.integer(*GOALS_OF_A_LIFE)
    places = truth.places
    here = _rounded(places[rng.integer(0, len(places) - 1)].tolist())
    asked: set[str] = set()
    life: LifeGoals = []
    for query in islice(_queries(rng, truth, rules), _MOST_QUERIES):
        categories = {i.label.category for i in query.instances if i.label is not None}
        if not asked.isdisjoint(categories):
            continue
        if query.text not in regions:
            regions[query.text] = truth.regions.of(Goal(query.text))
        region = regions[query.text]
        geodesic_m = region.distance(*here)
        if not rules.least_m <= geodesic_m <= rules.most_m:
            continue
        if not truth.touches_wide_area(region.view_points):
            continue
        start, here = _start(rng, truth, region, here, geodesic_m)
        life.append((query, start))
        asked |= categories
        if len(life) == wanted:
            break
    return life


def _queries(
    rng: RandomStream, truth: HouseGroundTruth | StoreyTruth, rules: EpisodeRules
) -> Iterator[Query]:
    """Categories and phrases in turn."""
    names = category_queries(rng.fork("categories"), truth, rules)
    phrases = phrase_queries(rng.fork("phrases"), truth, rules)
    return chain.from_iterable(zip(names, phrases, strict=False))


def _start(
    rng: RandomStream,
    truth: HouseGroundTruth | StoreyTruth,
    region: GoalRegion,
    here: Position,
    geodesic_m: float,
) -> tuple[Start, Position]:
    """A start here, and where the robot stands when it has found the goal."""
    x, y, z = here
    path = region.field.path(x, y, z)
    end = path[-1]
    gaps = np.linalg.norm(region.view_points[:, :2] - end, axis=1)
    straight_m = float(np.linalg.norm(region.view_points - here, axis=1).min())
    rooms = truth.rooms_on(path) if isinstance(truth, HouseGroundTruth) else 0
    yaw = round(rng.uniform(-math.pi, math.pi), 4)
    start = Start(Pose2(x, y, yaw), z, geodesic_m, min(straight_m, geodesic_m), rooms, end)
    return start, _rounded(region.view_points[int(gaps.argmin())].tolist())


def _rounded(point: list[float]) -> Position:
    """A position as it is in files, in millimetres."""
    x, y, z = (round(value, 3) for value in point)
    return x, y, z
