"""Stand-ins for models in runs: their draws are the episode's, and robots have none."""

from contextlib import closing
from dataclasses import replace

import numpy as np
import pytest

from box_scenes import room_boxes
from eval_runs import write_glb
from hypernav.app.build.agents import build_agent
from hypernav.app.build.components.component_specs import ComponentSpecs, PresetName
from hypernav.core.errors import TruthMissingError
from hypernav.core.geometry.transforms import Pose2
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.lab.evaluation.workers.job import Job
from hypernav.lab.evaluation.workers.worker import EpisodeWorker
from small_episodes import episode_from
from small_worlds import small_config, two_rooms

START = Pose2(2.5, 1.0, 0.0)
NOISY = ComponentSpecs(detector="noisy:fair", reasoner="noisy:0.5")


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    """Three rooms in a row with doors at different ends; the bed stands in the last."""
    boxes = [
        *room_boxes(12.0, 4.0),
        (None, (3.95, 0.0, 0.0), (4.05, 2.8, 2.5)),
        (None, (3.95, 3.8, 0.0), (4.05, 4.0, 2.5)),
        (None, (7.95, 0.0, 0.0), (8.05, 0.2, 2.5)),
        (None, (7.95, 1.2, 0.0), (8.05, 4.0, 2.5)),
        ("bed", (10.0, 2.3, 0.0), (11.9, 3.9, 0.5)),
    ]
    return write_glb(tmp_path_factory.mktemp("rooms") / "rooms.glb", boxes)


def records(folder, scene, ids, preset: PresetName):
    """What a worker of its own measures in these episodes, by name, times left out."""
    job = Job(folder, small_config(preset), NOISY)
    first = replace(episode_from(START, max_steps=60), scene_id=f"{scene}")
    with closing(EpisodeWorker(job)) as worker:
        done = [worker.run(replace(first, episode_id=id)) for id in ids]
    return {one.episode_id: one.model_dump(exclude={"seconds"}) for one in done}


@pytest.mark.slow
@pytest.mark.parametrize("preset", ["default", "paper"])
def test_a_record_depends_neither_on_workers_nor_on_the_order(tmp_path, scene, preset):
    together = records(tmp_path, scene, "abcd", preset)
    assert together == records(tmp_path, scene, "dcba", preset)
    assert together["b"] == records(tmp_path, scene, "b", preset)["b"]
    lengths = {one["path_length_m"] for one in together.values()}
    assert len(lengths) > 1  # the episodes differ in nothing but their draws


def test_an_agent_that_nobody_tells_the_truth_says_so():
    parts = build_agent(small_config(), NOISY)
    untold = EpisodeRun(parts.agent, two_rooms(), episode_from(START), rng=np.random.default_rng(0))
    with pytest.raises(TruthMissingError, match="only in a simulated world"):
        list(untold)
