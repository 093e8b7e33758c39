"""Pages and videos of failed episodes: what is kept, and what may be left out."""

from dataclasses import replace
from typing import get_args

import av
import numpy as np
import pytest
from hypothesis import given
from hypothesis.strategies import integers

from box_scenes import room_boxes, scene_of
from hypernav.core.embodiment import Action
from hypernav.core.errors import ModelUnavailableError
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.observation import Observation
from hypernav.core.trace import Mode, StepTrace
from hypernav.lab.episodes.episode_run import EpisodeStep
from hypernav.lab.episodes.recorder import EpisodeRecorder
from hypernav.lab.episodes.storyboard import Storyboard
from hypernav.lab.evaluation.choices import SaveChoice
from hypernav.lab.evaluation.failures import Failure
from hypernav.lab.evaluation.workers.job import Job
from hypernav.lab.evaluation.workers.worker import EpisodeWorker
from small_episodes import episode_from
from small_worlds import InScenes, small_config

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
    job = Job(folder, small_config(), save=save, make_agent=make_agent, world=InScenes(bedroom))
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


def test_colours_are_drawn_only_for_the_frames_of_a_failure(tmp_path):
    agent = Unseeing()
    assert worker(tmp_path, agent).run(EPISODES[0]).saved
    assert agent.runs == 1
    assert agent.coloured == [False] * 4
    # The next episode of the scene is drawn without colours again.
    worker_of_two, agent = worker(tmp_path, again := Unseeing()), again
    for episode in EPISODES:
        worker_of_two.run(episode)
    assert agent.coloured == [False] * 4 + [False] * 3


def test_an_agent_that_looks_at_colours_gets_them(tmp_path):
    agent = Turning()
    assert worker(tmp_path, agent).run(EPISODES[0]).saved
    assert agent.coloured == [True] * 4


def test_an_outage_leaves_a_page(tmp_path):
    outage = worker(tmp_path, Unanswered()).run(EPISODES[0])
    assert outage.failure is Failure.MODEL_UNAVAILABLE
    assert (tmp_path / outage.saved / "index.html").is_file()


class Listed(EpisodeRecorder):
    """A recorder that lists the steps, and the colour of each image."""

    def __init__(self):
        self.listed, self.colours = [], {}

    def record(self, step, grid, image):
        self.listed.append(step.step)
        if image is not None:
            self.colours[step.step] = int(image[0, 0, 0])


def shown(count, max_frames, *, coloured=False):
    """The steps of an episode as its storyboard gives them, and the colours of their images.

    Images of the world have colour 255; those drawn afterwards have that of the robot's x.
    """
    board = Storyboard(pose_of(0).to_transform(), max_frames)
    camera = PinholeCamera(1, 1, 1.0, 1.0, 0.0, 0.0)
    observation = Observation(
        painted(255), np.ones((1, 1), np.float32), camera, Transform.identity(), pose_of(0)
    )
    for number in range(count):
        trace = StepTrace(step=number, pose=(0.0, 0.0, 0.0), action=None, mode=Mode.EXPLORE)
        step = EpisodeStep(observation, trace, None)
        board.watch(step, pose_of(number + 1).to_transform(), coloured=coloured)
    listed = Listed()
    board.record(listed, lambda pose: painted(int(pose.translation[0])))
    return listed.listed, listed.colours


def painted(colour):
    return np.full((1, 1, 3), colour, dtype=np.uint8)


def pose_of(number):
    return Pose2(float(number), 0.0, 0.0)


@given(count=integers(0, 250), max_frames=integers(1, 70))
def test_frames_are_few_evenly_spread_and_include_both_ends(count, max_frames):
    steps, images = shown(count, max_frames)
    assert steps == list(range(count))
    assert len(images) <= max_frames + 1
    if count:
        assert {0, count - 1} <= set(images)
        strides = np.diff(sorted(images.keys() - {count - 1} | {0}))
        assert len(set(strides)) <= 1
        assert count <= max_frames or len(images) > max_frames / 2


@given(count=integers(1, 100))
def test_a_frame_is_drawn_from_where_the_robot_was_when_it_took_the_image(count):
    _, images = shown(count, 16)
    assert images == {number: number for number in images}


def test_an_image_with_colours_is_not_drawn_again():
    _, images = shown(5, 16, coloured=True)
    assert list(images.values()) == [255] * 5
