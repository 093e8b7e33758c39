import logging
from functools import partial

import pytest

from eval_runs import write_room
from hypernav.app.build.data.datasets import load_episodes
from hypernav.app.build.data.scenes import load_scene
from hypernav.core.episode import Life
from hypernav.lab.evaluation.workers.job import Job
from hypernav.lab.evaluation.workers.process_pool import ProcessPool
from hypernav.lab.evaluation.workers.worker_pool import Done
from small_worlds import InScenes, small_config


def doubted(path: str, scene: str):
    logging.getLogger("hypernav.simulator.worlds").warning("%s: seems to lie on its side", scene)
    return load_scene(path)


@pytest.mark.slow
def test_a_warning_of_a_worker_is_shown_once_by_its_owner(tmp_path, caplog):
    room = write_room(tmp_path / "room.glb")
    config = small_config()
    episode = load_episodes(f"scene:{room}#1", config.world, config.embodiment)[0]
    pool = ProcessPool(Job(tmp_path, config, world=InScenes(partial(doubted, str(room)))))
    try:
        pool.start(0)
        reports = pool.wait(120.0)
        for _ in range(2):
            pool.send(0, Life((episode,)))
            reports += pool.wait(120.0)
    finally:
        pool.close()
    assert sum(isinstance(report, Done) for report in reports) == 2
    assert [m for m in caplog.messages if "on its side" in m] == [
        f"{room}: seems to lie on its side"
    ]
