"""The data set ``scene:SCENE``: all goals of one scene, each from several drawn starts."""

from dataclasses import replace

import numpy as np

from hypernav.app.build.data.scenes import load_scene
from hypernav.app.build.data.sources import DatasetRequest
from hypernav.core.episode import Episode
from hypernav.core.errors import EpisodeError
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.naming.words import is_whole_number
from hypernav.simulator.worlds.navmesh.navmesh_surface import NavmeshSurface
from hypernav.simulator.worlds.surface.goal_regions import random_start
from hypernav.simulator.worlds.surface.walkable_surface import WalkableSurface
from hypernav.simulator.worlds.survey import SurveyedScene

STARTS_PER_GOAL = 5
"""Default number of starts per goal of ``scene:`` data sets."""

_MOST_STARTS = 10_000


def scene_episodes(request: DatasetRequest) -> list[Episode]:
    """All goals of one scene, each from several drawn starts."""
    scene, starts = request.argument, request.part
    if starts and not (is_whole_number(starts) and 0 < int(starts) <= _MOST_STARTS):
        raise EpisodeError(
            f"scene:{scene}#{starts:.20}: expected the number of starts per goal after the #, 1 to "
            f"{_MOST_STARTS:,}, or the whole path of a file"
        )
    count = int(starts) if starts else STARTS_PER_GOAL
    loaded = load_scene(scene, request.simulation)
    survey = SurveyedScene(loaded, request.simulation, request.embodiment)
    return _goals_and_starts(scene, survey, count, request)


def _goals_and_starts(
    scene: str, survey: SurveyedScene, count: int, request: DatasetRequest
) -> list[Episode]:
    """Every goal of a scene from several drawn starts, on the storeys in turn."""
    goals = survey.goals()
    if not goals:
        raise EpisodeError(f"scene:{scene}: no labelled object in it can be reached")
    episodes = []
    floors = _floors_of(survey.walkable)
    numbers = {goal: number for number, goal in enumerate(goals)}
    for done, goal in enumerate(goals):
        request.tell(done, len(goals))
        region = survey.goal_truth(Goal(goal))
        for number in range(count):
            spec = Episode(scene, f"{goal}-{number}", Goal(goal), Pose2(0.0, 0.0, 0.0))
            rng = np.random.default_rng(spec.seed(0))
            walkable, z = floors[number % len(floors)]
            start = random_start(walkable, rng, region, z=z)
            spec = replace(spec, start=start, start_z=z)
            episodes.append(replace(spec, object_category=goal, category_ids=numbers))
    return episodes


def _floors_of(walkable: WalkableSurface) -> list[tuple[WalkableSurface, float | None]]:
    """The surface on each storey that the robot can reach, with its height; None for one alone."""
    if isinstance(walkable, NavmeshSurface) and len(walkable.storeys_z) > 1:
        return [(walkable.on_storey(z), z) for z in walkable.storeys_z]
    return [(walkable, None)]
