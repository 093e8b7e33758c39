"""A worker leaves no thread behind, however it ends, and outlives the faults of its scenes."""

import threading
from contextlib import closing
from dataclasses import replace

import pytest

from eval_runs import write_room
from hypernav.app.build.data.scenes import load_scene
from hypernav.core.errors import (
    CameraError,
    ComponentError,
    ModelError,
    OutputError,
    SceneError,
    StartError,
    WorldError,
)
from hypernav.core.geometry.transforms import Pose2
from hypernav.lab.evaluation.failures import Failure
from hypernav.lab.evaluation.workers.job import Job
from hypernav.lab.evaluation.workers.worker import EpisodeWorker
from small_episodes import episode_from
from small_worlds import InScenes, small_config, two_rooms

START = Pose2(2.5, 1.0, 0.0)


class Stands:
    """Gives up at once; may fail instead."""

    def __init__(self, error=None):
        self.error, self.closed = error, False

    def reset(self, goal):
        pass

    def act(self, observation):
        if self.error is not None:
            raise self.error
        return None

    def close(self):
        self.closed = True


def threads():
    return {thread for thread in threading.enumerate() if thread.is_alive()}


def test_a_closed_world_has_no_threads():
    before = threads()
    with closing(two_rooms.__wrapped__()) as world:  # not the one that other tests share
        world.reset(episode_from(START))
        assert threads() > before
    assert threads() == before


@pytest.mark.parametrize("error", [None, ModelError("no such file")])
def test_a_worker_closes_world_and_agent_also_after_an_error(tmp_path, error):
    before, agent = threads(), Stands(error)
    room = write_room(tmp_path / "room.glb")
    job = Job(tmp_path, small_config(), make_agent=lambda: agent)
    episode = replace(episode_from(START), scene_id=f"{room}")
    with closing(EpisodeWorker(job)) as worker:
        if error is None:
            worker.run(episode)
        else:
            with pytest.raises(ModelError):
                worker.run(episode)
        assert threads() > before
    assert threads() == before
    assert agent.closed


def test_a_film_is_kept_in_the_folder_of_the_run_alone(tmp_path):
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "episodes").symlink_to(tmp_path / "elsewhere")
    job = Job(tmp_path / "run", small_config(), make_agent=Stands, save="videos")
    episode = replace(episode_from(START), scene_id=str(write_room(tmp_path / "room.glb")))
    said = pytest.raises(OutputError, match="episodes is a link")
    with closing(EpisodeWorker(job)) as worker, said:
        worker.run(episode)
    assert not list((tmp_path / "elsewhere").iterdir())


@pytest.mark.parametrize("error", [SceneError, StartError, WorldError, CameraError])
def test_a_fault_of_the_simulator_is_in_no_rate_and_ends_no_worker(tmp_path, error):
    faults = [error("out of order")]

    def scene(name):
        if faults:
            raise faults.pop()
        return load_scene(name)

    job = Job(tmp_path, small_config(), make_agent=Stands, world=InScenes(scene))
    episode = replace(episode_from(START), scene_id=str(write_room(tmp_path / "room.glb")))
    with closing(EpisodeWorker(job)) as worker:
        failed = worker.run(episode)
        passed = worker.run(episode)
    assert not failed.counts
    assert failed.failure is Failure.SIMULATOR_ERROR
    assert failed.why == f"{error.__name__}: out of order"
    assert passed.counts


@pytest.mark.parametrize("error", [SceneError("mine"), WorldError("mine"), KeyError("mine")])
def test_an_agents_own_error_is_never_the_simulators(tmp_path, error):
    def mine():
        return Stands(error)

    episode = replace(episode_from(START), scene_id=str(write_room(tmp_path / "room.glb")))
    said = pytest.raises(ComponentError, match=r"^mine: act raised .*Error: .*mine")
    with closing(EpisodeWorker(Job(tmp_path, small_config(), make_agent=mine))) as worker, said:
        worker.run(episode)
