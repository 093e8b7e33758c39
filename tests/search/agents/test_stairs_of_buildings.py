"""Searches in generated buildings whose stairs once kept the robot until its steps ran out."""

from dataclasses import replace
from pathlib import Path

import pytest

from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.data.datasets import load_episodes
from hypernav.app.build.presets import preset
from hypernav.lab.evaluation.record import Outcome
from hypernav.lab.evaluation.workers.job import Job
from hypernav.lab.evaluation.workers.worker import EpisodeWorker

CONFIG = preset("default").with_(embodiment={"body": {"max_step_m": 0.2}})


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "most_steps"),
    [
        ("3056-1", 330),  # the navigation mesh lies 0.4 m above the first step
        ("3061-23", 330),  # a railing stands before the middle of the stairs' head
        ("3152-14", 500),  # two flights, one above the other, and each head is beyond a railing
        ("3172-17", 420),  # at the foot of the stairs it touches something, whatever it tries
        ("3175-14", 330),  # it comes along the railing of L-shaped stairs, whose head is askew
        ("3222-11", 300),  # half landings of 3.9 m² lie between its floors
        ("3209-17", 400),  # its stairs were seen in one image alone, from beside their railing
    ],
)
def test_its_goal_is_found_over_the_stairs(name: str, most_steps: int):
    building = int(name.split("-")[0])
    episodes = load_episodes(f"storeys-train#{building}:{building + 1}")
    episode = next(one for one in episodes if one.episode_id == name)
    worker = EpisodeWorker(Job(Path(), CONFIG, ComponentSpecs(agent="hypernav"), 0))
    record = worker.run(replace(episode, max_steps=most_steps))
    assert record.outcome is Outcome.FOUND
