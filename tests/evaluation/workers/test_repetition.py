"""Failed episodes run again for their page: what is kept, and what must not differ."""

from dataclasses import replace
from typing import get_args

import av
import numpy as np
import pytest

from box_scenes import room_boxes, scene_of
from eval_runs import record
from hypernav.core.actions import Action
from hypernav.core.errors import ModelUnavailableError, RepetitionError
from hypernav.core.geometry.transforms import Pose2
from hypernav.evaluation.failures.classification import Failure
from hypernav.evaluation.save_choice import SaveChoice
from hypernav.evaluation.workers.repetition import check_repetition
from hypernav.evaluation.workers.worker import EpisodeWorker, Job
from small_episodes import episode_from
from small_worlds import small_config

START = Pose2(1.0, 3.0, 0.0)
EPISODES = [
    replace(episode_from(START, "bed", max_steps=60), episode_id="found"),
    replace(episode_from(START, "bed", max_steps=3), episode_id="too short"),
]


def bedroom(name):
    return scene_of(*room_boxes(6.0, 4.0), ("bed", (4.0, 0.1, 0.0), (5.9, 1.7, 0.5)), name=name)


class Turning:
    """Turns on the spot a few times, then stops; notes how often it began and what it saw."""

    def __init__(self, turns=lambda run: 3):
        self.turns, self.runs, self.coloured = turns, 0, []

    def reset(self, goal):
        self.runs += 1
        self.left = self.turns(self.runs)

    def act(self, observation):
        self.coloured.append(bool(observation.rgb.any()))
        self.left -= 1
        return Action.TURN_LEFT if self.left >= 0 else Action.STOP


class Unseeing(Turning):
    looks_at_colours = False


class Unanswered(Unseeing):
    def act(self, observation):
        raise ModelUnavailableError("no answer for 120 s")


def worker(folder, agent=None, *, save: SaveChoice = "failures"):
    make_agent = None if agent is None else lambda: agent
    job = Job(folder, small_config(), save=save, make_agent=make_agent, open_scene=bedroom)
    return EpisodeWorker(job)


@pytest.fixture(scope="module")
def records(tmp_path_factory):
    """The same episodes with every choice of what is saved, and the folder of the failures."""
    folders = {save: tmp_path_factory.mktemp(save) for save in get_args(SaveChoice)}
    workers = {save: worker(folder, save=save) for save, folder in folders.items()}
    runs = {save: [each.run(episode) for episode in EPISODES] for save, each in workers.items()}
    return runs, folders


def test_only_the_failed_episode_is_kept(records):
    runs, folders = records
    found, failed = runs["failures"]
    assert (found.success, found.saved) == (True, "")
    assert (failed.success, failed.saved) == (False, runs["videos"][1].saved)
    assert [folder.name for folder in (folders["failures"] / "episodes").iterdir()] == [
        failed.saved.removeprefix("episodes/")
    ]


def test_the_page_and_the_video_of_a_failure_are_those_of_a_run_that_saves_all(records):
    runs, folders = records
    kept, expected = (folders[save] / runs["videos"][1].saved for save in ("failures", "videos"))
    assert {path.name for path in kept.iterdir()} == {path.name for path in expected.iterdir()}
    assert (kept / "trace.jsonl").read_bytes() == (expected / "trace.jsonl").read_bytes()
    one, two = (
        [
            frame.to_ndarray(format="rgb24")
            for frame in av.open(str(folder / "episode.mp4")).decode()
        ]
        for folder in (kept, expected)
    )
    assert len(one) == len(two) > 3
    assert all(map(np.array_equal, one, two))


def test_what_is_saved_changes_nothing_else_in_a_record(records):
    runs, _ = records
    timeless = {
        save: [each.model_dump(exclude={"seconds", "saved"}) for each in each_of]
        for save, each_of in runs.items()
    }
    assert timeless["failures"] == timeless["none"] == timeless["videos"]


def test_colours_are_drawn_only_when_a_failure_runs_again(tmp_path):
    agent = Unseeing()
    assert worker(tmp_path, agent).run(EPISODES[0]).saved
    assert agent.runs == 2
    assert agent.coloured == [False] * 4 + [True] * 4
    # The next episode of the scene is drawn without colours again.
    worker_of_two, agent = worker(tmp_path, again := Unseeing()), again
    for episode in EPISODES:
        worker_of_two.run(episode)
    assert agent.coloured == ([False] * 4 + [True] * 4) + ([False] * 3 + [True] * 3)


def test_an_agent_that_looks_at_colours_runs_once(tmp_path):
    agent = Turning()
    assert worker(tmp_path, agent).run(EPISODES[0]).saved
    assert agent.runs == 1
    assert agent.coloured == [True] * 4


def test_an_outage_is_not_repeated(tmp_path):
    agent = Unanswered()
    outage = worker(tmp_path, agent).run(EPISODES[0])
    assert (outage.failure, outage.saved, agent.runs) == (Failure.MODEL_UNAVAILABLE, "", 1)


def test_an_agent_that_does_something_else_the_second_time_is_refused(tmp_path):
    agent = Unseeing(turns=lambda run: 2 * run)
    with pytest.raises(RepetitionError, match=r"found of .*steps 3, then 5\. .*--save videos"):
        worker(tmp_path, agent).run(EPISODES[0])


def test_times_and_folders_of_two_runs_may_differ():
    first = record(failure=Failure.NEVER_SEEN)
    check_repetition(first, first.model_copy(update={"saved": "episodes/a", "seconds": {}}))


def test_every_field_that_differs_is_named():
    first = record(failure=Failure.NEVER_SEEN, why="it was never in the image")
    second = record(failure=Failure.NEVER_SEEN, why="it turned away", spl=0.25)
    with pytest.raises(RepetitionError) as refused:
        check_repetition(first, second)
    message = str(refused.value)
    assert "spl 0.0, then 0.25" in message
    assert "why 'it was never in the image', then 'it turned away'" in message
    assert "path_length_m" not in message
