"""Runs that are killed give what uninterrupted runs give."""

import os
import random
import signal
import subprocess
import sys
import time
from dataclasses import replace
from functools import partial

import pytest

from certainty import certain
from eval_runs import SMALL, timeless_lines, write_room
from hypernav.app.build.data.datasets import load_episodes
from hypernav.core.episode import Life
from hypernav.lab.evaluation.runner import ATTEMPTS, run_episodes
from hypernav.lab.evaluation.store.run_store import RunStore, read_records
from hypernav.lab.evaluation.workers.job import Job
from hypernav.lab.evaluation.workers.process_pool import ProcessPool
from hypernav.lab.evaluation.workers.worker_pool import Done, Lost, Ready
from small_worlds import small_config
from tired import SlowAgent

MAX_STEPS = 25


class KillingPool(ProcessPool):
    """Workers of which one is killed after each of the first episodes, however fast they are."""

    def __init__(self, job, rng, kills):
        super().__init__(job)
        self._rng, self.kills_left, self._killed = rng, kills, []

    def wait(self, seconds):
        reports = super().wait(seconds)
        # A killed worker stays among the started ones until its loss is reported.
        running = [at for at in self._started if self._started[at].process not in self._killed]
        if self.kills_left and running and any(isinstance(report, Done) for report in reports):
            victim = self._started[self._rng.choice(sorted(running))].process
            victim.kill()
            self._killed.append(victim)
            self.kills_left -= 1
        return reports


def run(folder, room, pool_of, workers=2, starts=6):
    config = small_config()
    found = load_episodes(f"scene:{room}#{starts}", config.world, config.embodiment)
    episodes = [replace(episode, max_steps=MAX_STEPS) for episode in found]
    job = Job(folder, config, make_agent=partial(SlowAgent, config, 0.02))
    with RunStore(folder, {"test": "survival"}) as store:
        return run_episodes(episodes, store, pool_of(job), workers=workers)


@pytest.fixture(scope="module")
def room(tmp_path_factory):
    return write_room(tmp_path_factory.mktemp("scene") / "room.glb")


@pytest.mark.slow
def test_results_depend_neither_on_the_number_of_workers_nor_on_their_deaths(tmp_path, room):
    run(tmp_path / "one", room, ProcessPool, workers=1)
    assert len(timeless_lines(tmp_path / "one")) == 12
    kills = ATTEMPTS - 1  # one more may all hit the same episode, which is then given up
    for seed in (1, 2):
        folder = tmp_path / f"killed-{seed}"
        rng = random.Random(seed)
        progress = run(folder, room, lambda job, rng=rng: KillingPool(job, rng, kills))
        assert progress.losses == kills
        assert timeless_lines(folder) == timeless_lines(tmp_path / "one")


@pytest.mark.slow
def test_a_run_killed_at_20_random_moments_equals_an_uninterrupted_one(tmp_path, room):
    def command(folder):
        program = "from hypernav.app.cli.main import main; main()"
        options = ["--workers", "2", "--max-steps", str(MAX_STEPS), "--quiet", *SMALL]
        where = [f"scene:{room}#20", "--out", str(folder)]
        return [sys.executable, "-c", program, "eval", *where, *options]

    subprocess.run(command(tmp_path / "whole"), check=True)
    rng, killed = random.Random(7), tmp_path / "killed"
    kills, lines = 0, []
    while kills < 20:
        process = subprocess.Popen(command(killed))
        # Half of the moments are while it starts, half soon after results begin to come.
        deadline = time.monotonic() + rng.uniform(0.0, 12.0)
        while time.monotonic() < deadline and process.poll() is None:
            time.sleep(0.02)
            now = len(read_whole_lines(killed))
            if now > len(lines) and rng.random() < 0.2:
                break
        if process.poll() is not None:
            assert process.returncode == 0
            break
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
        kills += 1
        before, lines = lines, read_whole_lines(killed)
        assert lines[: len(before)] == before  # nothing that was written is ever lost
    subprocess.run(command(killed), check=True)
    assert kills == 20
    assert timeless_lines(killed) == timeless_lines(tmp_path / "whole")
    assert len(read_records(killed)) == 40


def read_whole_lines(folder):
    path = folder / "episodes.jsonl"
    content = path.read_bytes() if path.exists() else b""
    return content[: content.rfind(b"\n") + 1].splitlines()


def started_worker(folder):
    """A process of its own that starts a pool's first worker, and that worker's number."""
    script = folder / "owner.py"
    script.write_text(
        "import time; from pathlib import Path\n"
        "from hypernav.lab.evaluation.workers.process_pool import ProcessPool\n"
        "from hypernav.lab.evaluation.workers.job import Job\n"
        "if __name__ == '__main__':\n"
        f"    pool = ProcessPool(Job(Path({str(folder)!r})))\n"
        "    pool.start(0)\n"
        "    print(pool._started[0].process.pid, flush=True)\n"
        "    time.sleep(60)\n"
    )
    owner = subprocess.Popen([sys.executable, str(script)], stdout=subprocess.PIPE, text=True)
    return owner, int(certain(owner.stdout).readline())


@pytest.mark.slow
def test_the_first_worker_is_started_with_ctrl_c_blocked(tmp_path):
    """The resource tracker of multiprocessing, started with it, unblocks Ctrl-C."""
    owner, worker = started_worker(tmp_path)
    with open(f"/proc/{worker}/status") as file:
        (blocked,) = (line.split()[1] for line in file if line.startswith("SigBlk"))
    owner.kill()
    owner.communicate()
    assert int(blocked, 16) & 1 << (signal.SIGINT - 1)


@pytest.mark.slow
def test_workers_die_with_their_owner(tmp_path):
    owner, worker = started_worker(tmp_path)
    time.sleep(5.0)
    owner.kill()
    owner.communicate()
    deadline = time.monotonic() + 20.0
    while time.monotonic() < deadline and is_alive(worker):
        time.sleep(0.1)
    assert not is_alive(worker)


def is_alive(process_id):
    try:
        with open(f"/proc/{process_id}/stat") as file:
            return file.read().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def test_what_a_worker_sent_before_it_died_counts(tmp_path, room):
    config = small_config()
    episodes = load_episodes(f"scene:{room}#1", config.world, config.embodiment)
    episode = replace(episodes[0], max_steps=3)
    pool = ProcessPool(Job(tmp_path, config))
    try:
        pool.start(0)
        hired = pool._started[0]
        assert hired.pipe.poll(60)
        assert pool.wait(1.0) == [Ready(0)]
        pool.send(0, Life((episode,)))
        assert hired.pipe.poll(60)
        hired.process.kill()
        hired.process.join()
        first, second = pool.wait(1.0), pool.wait(1.0)
    finally:
        pool.close()
    assert isinstance(first[0], Done)
    assert first[0].records[0].key == episode.key
    assert isinstance(second[0], Lost)
    assert "SIGKILL" in second[0].why
