from dataclasses import fields, replace

import numpy as np
import pytest

from hypernav.core.episode import Episode, ObjectName
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal

EPISODE = Episode("houses:1000", "7", Goal("bed"), Pose2(1.0, 2.0, 0.5))
SAID_BESIDES = {
    "view_points": np.zeros((2, 3)),
    "objects": (ObjectName("bed_1", 1),),
    "object_category": "beds",
    "category_ids": {"bed": 1},
}
OTHERS = {
    "scene_id": "houses:1001",
    "episode_id": "8",
    "goal": Goal("sofa"),
    "start": Pose2(1.0, 2.0, 0.6),
    "group": "unseen",
    "start_z": 0.0,
    "max_steps": 501,
    "success_distance_m": 0.2,
    "life": "1000-0",
    "max_life_steps": 500,
}


def test_every_field_is_part_of_the_task_or_said_besides():
    assert {one.name for one in fields(Episode)} == OTHERS.keys() | SAID_BESIDES.keys()


@pytest.mark.parametrize("name", SAID_BESIDES)
def test_what_a_file_says_besides_makes_no_other_task(name):
    told = replace(EPISODE, **{name: SAID_BESIDES[name]})
    assert told == EPISODE
    assert repr(told) == repr(EPISODE)


@pytest.mark.parametrize("name", OTHERS)
def test_any_other_value_makes_another_task(name):
    other = replace(EPISODE, **{name: OTHERS[name]})
    assert other != EPISODE
    assert repr(other) != repr(EPISODE)


def test_the_seed_is_of_scene_episode_and_run_wherever_the_files_are():
    seeds = {
        one.seed(run)
        for one in (EPISODE, replace(EPISODE, episode_id="8"), replace(EPISODE, scene_id="b"))
        for run in (0, 1)
    }
    assert len(seeds) == 6
    here, there = (replace(EPISODE, scene_id=f"{folder}/x.glb") for folder in ("a", "b"))
    assert here.seed(0) == there.seed(0)
    assert replace(EPISODE, start=Pose2(0.0, 0.0, 0.0), max_steps=9).seed(1) == EPISODE.seed(1)
