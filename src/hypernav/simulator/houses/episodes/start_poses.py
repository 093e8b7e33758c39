"""Start poses of episodes, with their distances to the goal, on one storey or across several.

On several storeys the robot climbs stairs, and a goal is only on one storey. The starts are in turn
on the storey of the goal, below it and above it, as far as the building has such goals.
"""

import math
from dataclasses import dataclass
from itertools import islice

import numpy as np

from hypernav.core.geometry.transforms import Pose2
from hypernav.simulator.houses.episodes.building_truth import HouseGroundTruth, StoreyTruth
from hypernav.simulator.houses.episodes.queries import EpisodeRules, Query, category_queries
from hypernav.simulator.houses.random_stream import RandomStream
from hypernav.simulator.worlds.surface.goal_regions import GoalRegion

_START_SAMPLES = 60
_STRAIGHT_RATIO = 1.05
_STRAIGHT_KEPT_SHARE = 0.2
"""Share that is kept of starts with a straight path to the goal, as in Habitat's generator."""

_DIRECTIONS = ("same", "above", "below")
_STOREY_START_SAMPLES = 40


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


def across_storeys(
    rng: RandomStream, truth: StoreyTruth, rules: EpisodeRules, count: int
) -> list[tuple[Query, Start]]:
    """Goals with starts on the same storey, below and above them in turn."""
    queries = list(islice(category_queries(rng.fork("goals"), truth, rules), len(rules.categories)))
    queries = list({query.text: query for query in queries}.values())
    turns = {direction: list(queries) for direction in _DIRECTIONS}
    drawn: list[tuple[Query, Start]] = []
    for number in range(count):
        direction, own = _DIRECTIONS[number % 3], rng.fork("start", number)
        turn = turns[direction]
        for _ in range(len(turn)):
            query = turn.pop(0)
            start = _storey_start(own.fork(query.text), truth, query, direction, rules)
            if start is not None:
                turn.append(query)
                drawn.append((query, start))
                break
    return drawn


def _storey_start(
    rng: RandomStream, truth: StoreyTruth, query: Query, direction: str, rules: EpisodeRules
) -> Start | None:
    """The farther of two random starts from which a wide path leads to the goal."""
    storey, region = truth.storey_of(query.instances), truth.region(query.text)
    if storey is None or not truth.touches_wide_area(region.view_points):
        return None
    numbers = range(len(truth.starts))
    wanted = {"same": [storey], "above": numbers[:storey], "below": numbers[storey + 1 :]}
    places = np.concatenate([np.zeros((0, 3)), *(truth.starts[k] for k in wanted[direction])])
    if len(places) == 0:
        return None
    found: list[tuple[float, float, float, float]] = []
    for _ in range(_STOREY_START_SAMPLES):
        x, y, z = (round(v, 3) for v in places[rng.integer(0, len(places) - 1)].tolist())
        geodesic_m = region.distance(x, y, z)
        if rules.least_m <= geodesic_m <= rules.most_m:
            found.append((geodesic_m, x, y, z))
        if len(found) == 2:
            break
    if not found:
        return None
    geodesic_m, x, y, z = max(found)
    gaps = np.linalg.norm(region.view_points - (x, y, z), axis=1)
    yaw = round(rng.uniform(-math.pi, math.pi), 4)
    end = region.field.path(x, y, z)[-1]
    straight_m = min(float(gaps.min()), geodesic_m)
    return Start(Pose2(x, y, yaw), z, geodesic_m, straight_m, 0, end, direction)
