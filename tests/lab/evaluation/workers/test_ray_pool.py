"""Ray on two nodes of this machine gives what local processes give."""

import os
import signal
from dataclasses import replace

import pytest

from eval_runs import timeless_lines, write_room
from hypernav.app.build.data.datasets import load_episodes
from hypernav.core.episode import lives_of
from hypernav.core.errors import HyPerNavError, RunFolderError
from hypernav.lab.evaluation.runner import run_episodes
from hypernav.lab.evaluation.store.run_store import RunStore
from hypernav.lab.evaluation.workers.job import Job
from hypernav.lab.evaluation.workers.process_pool import ProcessPool
from hypernav.lab.evaluation.workers.ray_pool import RayPool
from hypernav.lab.evaluation.workers.worker_pool import Done, Lost
from small_worlds import small_config

pytestmark = [
    pytest.mark.slow,
    # Ray leaves pipes and sockets to the garbage collector.
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
    pytest.mark.filterwarnings("ignore::FutureWarning"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
]


@pytest.fixture(scope="module")
def cluster():
    pytest.importorskip("ray")
    import ray
    from ray.cluster_utils import Cluster

    node = {"num_cpus": 1, "object_store_memory": 80_000_000, "include_dashboard": False}
    cluster = Cluster(initialize_head=True, head_node_args=node)
    cluster.add_node(num_cpus=1, object_store_memory=80_000_000)
    yield cluster
    ray.shutdown()
    cluster.shutdown()


class KillingPool(RayPool):
    """Kills the process of one worker right after that has finished its second episode."""

    killed = 0

    def wait(self, seconds):
        reports = super().wait(seconds)
        for report in reports:
            if (
                isinstance(report, Done)
                and not self.killed
                and report.records[0].episode_id != "bed-0"
            ):
                actor = self._actors[report.worker]
                os.kill(self._ray.get(actor.process_id.remote()), signal.SIGKILL)
                self.killed += 1
        return reports


def run(folder, episodes, pool):
    with RunStore(folder, {"test": "ray"}) as store:
        return run_episodes(episodes, store, pool, workers=2)


def test_two_nodes_with_a_killed_worker_equal_the_local_run(tmp_path, cluster):
    config = small_config()
    room = write_room(tmp_path / "room.glb")
    found = load_episodes(f"scene:{room}#4", config.world, config.embodiment)
    episodes = [replace(episode, max_steps=25) for episode in found]

    def job(name):
        return Job(tmp_path / name, config)

    run(tmp_path / "local", episodes, ProcessPool(job("local")))
    pool = KillingPool(job("ray"), cluster.address)
    progress = run(tmp_path / "ray", episodes, pool)
    assert pool.killed == 1
    assert progress.losses == 1
    assert timeless_lines(tmp_path / "ray") == timeless_lines(tmp_path / "local")


def test_both_nodes_work(tmp_path, cluster):
    import ray

    pool = RayPool(Job(tmp_path, small_config()), cluster.address)
    try:
        for worker in (0, 1):
            pool.start(worker)
        nodes = ray.get([pool._actors[w].node.remote() for w in (0, 1)])
    finally:
        pool.close()
    assert len(set(nodes)) == 2


def test_a_lost_worker_is_reported(tmp_path, cluster):
    import ray

    pool = RayPool(Job(tmp_path, small_config()), cluster.address)
    try:
        pool.start(0)
        process: int = ray.get(pool._actors[0].process_id.remote())
        assert pool.wait(60.0)
        pool.send(0, lives_of(load_episodes(f"scene:{write_room(tmp_path / 'room.glb')}#1"))[0])
        os.kill(process, signal.SIGKILL)
        reports = []
        while not reports:
            reports = pool.wait(5.0)
    finally:
        pool.close()
    assert isinstance(reports[0], Lost)


@pytest.mark.parametrize("address", ["127.0.0.1:1", "ray://127.0.0.1:1", "here:there"])
def test_no_cluster_is_one_clear_error(tmp_path, address):
    with pytest.raises(HyPerNavError, match="no Ray cluster answers there"):
        RayPool(Job(tmp_path), address)


def test_videos_stay_where_they_are_made(tmp_path):
    with pytest.raises(RunFolderError, match="--save"):
        RayPool(Job(tmp_path, save="videos"), "auto")
