"""Generation of one building's episodes, in Habitat's format.

Goals have no view points: a house has fifty thousand, and running an episode computes them from the
scene anyway. Files for other programs get all of them by `with_view_points`, with the same numbers
as in the scene, so that both give the same measures.

A life is several goals, one after the other, each from where the last one is. Lives are generated
for a robot that makes no mistake: every goal's start is the end of the shortest path to the one
before. A real robot stands elsewhere, so every goal can be reached from everywhere.
"""

import math
from collections.abc import Iterator, Sequence
from itertools import chain, islice

import numpy as np
from jaxtyping import Float64

from hypernav.core.errors import EpisodeError
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.world import Instance, Position
from hypernav.lab.datasets.building_splits import EPISODES_PER_HOUSE, LIVES_PER_BUILDING, GoalStyle
from hypernav.lab.datasets.habitat_format import (
    AgentState,
    EpisodeDataset,
    ObjectGoal,
    ObjectNavEpisode,
    ViewPoint,
    pose_to_habitat,
    positions_from_habitat,
    positions_to_habitat,
)
from hypernav.simulator.houses.building import Building
from hypernav.simulator.houses.episodes.building_truth import (
    BuildingTruth,
    HouseGroundTruth,
    StoreyTruth,
    truth_of,
)
from hypernav.simulator.houses.episodes.queries import (
    RULES,
    EpisodeRules,
    Query,
    category_queries,
    phrase_queries,
)
from hypernav.simulator.houses.episodes.start_poses import Start, across_storeys, sample_start
from hypernav.simulator.houses.random_stream import RandomStream
from hypernav.simulator.worlds.scenes.scene import Scene
from hypernav.simulator.worlds.surface.goal_regions import GoalRegion

EPISODES_VERSION = 2
"""Version of the episodes; increased whenever the same house gives others than before."""
GOALS_OF_A_LIFE = (5, 10)
"""Least and greatest number of goals of a life."""

QueryWithStart = tuple[Query, Start]
LifeGoals = list[QueryWithStart]

_MOST_QUERIES = 400
_MOST_QUERIES_OF_A_LIFE = 150
_MOST_TRIES = 20
_DIGITS = 5


def house_episodes(scene: Scene, building: Building, style: GoalStyle) -> EpisodeDataset:
    """Episodes of one building; the same for the same scene.

    Raises:
        EpisodeError: The building contains no possible goal.
        SceneError: The robot fits nowhere.
    """
    rng = RandomStream(EPISODES_VERSION, *building.key, style)
    rules = RULES[building.kind]
    truth = truth_of(scene)
    lives: list[LifeGoals] = []
    if style == "lives":
        lives = draw_lives(rng, truth, rules)
        drawn = [goal for life in lives for goal in life]
    elif isinstance(truth, StoreyTruth):
        drawn = across_storeys(rng, truth, rules, EPISODES_PER_HOUSE)
    else:
        drawn = _sample(rng, truth, style, rules)
    if not drawn:
        raise EpisodeError(
            f"{scene.name}: holds no goal that is {rules.least_m:g} to "
            f"{rules.most_m:g} m away from a possible start"
        )
    writer = _Writer(truth)
    episodes = [writer.episode(k, query, start, style) for k, (query, start) in enumerate(drawn)]
    return EpisodeDataset(
        episodes=_of_lives(episodes, lives) if lives else episodes,
        goals_by_category={
            f"{scene.name}_{query.text}": [writer.goal(i) for i in _reachable(truth, query)]
            for query, _ in drawn
        },
    )


def _of_lives(
    episodes: Sequence[ObjectNavEpisode], lives: Sequence[LifeGoals]
) -> list[ObjectNavEpisode]:
    """The episodes named by their lives and the numbers of their goals, from 1."""
    names = [(life, number) for life, goals in enumerate(lives) for number in range(len(goals))]
    return [
        episode.model_copy(
            update={
                "episode_id": f"{life}.{number + 1}",
                "info": (episode.info or {}) | {"life": str(life)},
            }
        )
        for episode, (life, number) in zip(episodes, names, strict=True)
    ]


def with_view_points(dataset: EpisodeDataset, scene: Scene) -> EpisodeDataset:
    """The same episodes with every view point of their goals."""
    truth = truth_of(scene)
    regions, done = truth.regions, dict[int | str, ObjectGoal]()
    for goal in (goal for goals in dataset.goals_by_category.values() for goal in goals):
        if goal.object_id not in done:
            instance = scene.instances[int(goal.object_id)]
            middle = positions_from_habitat(np.array([goal.position]))[0]
            points = [_view_point(p, middle) for p in regions.view_points(instance)]
            done[goal.object_id] = goal.model_copy(update={"view_points": points})
    goals = {
        key: [done[goal.object_id] for goal in goals]
        for key, goals in dataset.goals_by_category.items()
    }
    return dataset.model_copy(update={"goals_by_category": goals})


def _sample(
    rng: RandomStream, truth: HouseGroundTruth, style: GoalStyle, rules: EpisodeRules
) -> list[QueryWithStart]:
    """Queries with starts, in random order."""
    queries = (category_queries if style == "categories" else phrase_queries)(
        rng.fork("goals"), truth, rules
    )
    drawn: list[QueryWithStart] = []
    unreachable: set[str] = set()
    for number, query in enumerate(islice(queries, _MOST_QUERIES)):
        if query.text in unreachable:
            continue
        region = truth.region(query.text)
        start = sample_start(rng.fork("start", number), truth, region, rules)
        if start is None:
            unreachable.add(query.text)
            continue
        drawn.append((query, start))
        if len(drawn) == EPISODES_PER_HOUSE:
            break
    return rng.fork("order").shuffled(drawn)


def draw_lives(
    rng: RandomStream, truth: HouseGroundTruth | StoreyTruth, rules: EpisodeRules
) -> list[LifeGoals]:
    """The lives of a building: goals of different categories, every other one a phrase."""
    tries = (_draw_life(rng.fork("life", number), truth, rules) for number in range(_MOST_TRIES))
    whole = (life for life in tries if len(life) >= GOALS_OF_A_LIFE[0])
    return list(islice(whole, LIVES_PER_BUILDING))


def _draw_life(
    rng: RandomStream, truth: HouseGroundTruth | StoreyTruth, rules: EpisodeRules
) -> LifeGoals:
    wanted = rng.integer(*GOALS_OF_A_LIFE)
    places = truth.places
    here = _rounded(places[rng.integer(0, len(places) - 1)].tolist())
    asked: set[str] = set()
    life: LifeGoals = []
    for query in islice(_queries(rng, truth, rules), _MOST_QUERIES_OF_A_LIFE):
        categories = {i.label.category for i in query.instances if i.label is not None}
        if not asked.isdisjoint(categories):
            continue
        region = truth.region(query.text)
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


def _reachable(truth: BuildingTruth, query: Query) -> list[Instance]:
    return [i for i in query.instances if len(truth.regions.view_points(i)) > 0]


class _Writer:
    """Converts queries and instances of one house to Habitat's format; every instance once."""

    def __init__(self, truth: BuildingTruth) -> None:
        self._site = truth
        self._goals: dict[int, ObjectGoal] = {}

    def episode(
        self, number: int, query: Query, start: Start, style: GoalStyle
    ) -> ObjectNavEpisode:
        position, rotation = pose_to_habitat(start.pose, start.floor_z)
        info = {
            "geodesic_distance": round(start.geodesic_m, 4),
            "euclidean_distance": round(start.euclidean_m, 4),
            "rooms_on_path": start.rooms,
            "closest_goal_object_id": self._nearest(query, start),
            "near_miss_object_ids": [i.id for i in query.near_misses],
        }
        if start.goal_is is not None:
            info["goal_is"] = start.goal_is
        if style != "categories":
            info["vocabulary"] = query.vocabulary
            info["is_description"] = query.is_description
        return ObjectNavEpisode(
            episode_id=str(number),
            scene_id=self._site.scene.name,
            start_position=_rounded3(position),
            start_rotation=_rounded4(rotation),
            object_category=query.text,
            info=info,
            goals=[],
        )

    def goal(self, instance: Instance) -> ObjectGoal:
        if instance.id not in self._goals:
            middle = (np.array(instance.box_min) + np.array(instance.box_max)) / 2.0
            self._goals[instance.id] = ObjectGoal(
                object_category=instance.label.category if instance.label else "",
                object_id=instance.id,
                object_name=instance.name,
                position=_rounded3(tuple(positions_to_habitat(middle[None])[0].tolist())),
            )
        return self._goals[instance.id]

    def _nearest(self, query: Query, start: Start) -> int:
        """Id of the instance whose view point ends the shortest path."""
        gaps = {
            i.id: np.abs(self._site.regions.view_points(i)[:, :2] - start.end).max(axis=1).min()
            for i in _reachable(self._site, query)
        }
        return min(gaps, key=lambda number: (gaps[number], number))


def _view_point(point: Float64[np.ndarray, "3"], middle: Float64[np.ndarray, "3"]) -> ViewPoint:
    """View point that looks at the object's centre; its IoU is not known, hence null."""
    x, y, z = point.tolist()
    yaw = math.atan2(float(middle[1]) - y, float(middle[0]) - x)
    position, rotation = pose_to_habitat(Pose2(x, y, yaw), z)
    # Positions are exact: measures depend on them. Adding 0.0 turns -0.0 into 0.0.
    x, y, z = (value + 0.0 for value in position)
    state = AgentState(position=(x, y, z), rotation=_rounded4(rotation))
    return ViewPoint(agent_state=state, iou=None)


def _rounded3(values: tuple[float, float, float]) -> tuple[float, float, float]:
    # Adding 0.0 turns -0.0 into 0.0.
    x, y, z = (round(v, _DIGITS) + 0.0 for v in values)
    return x, y, z


def _rounded4(values: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    x, y, z, w = (round(v, _DIGITS) + 0.0 for v in values)
    return x, y, z, w
