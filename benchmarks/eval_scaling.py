"""How an evaluation scales: with workers, and with episodes that share a model server.

Run: python benchmarks/eval_scaling.py workers [--dataset houses-train#3000:3004] [--episodes 16]
     python benchmarks/eval_scaling.py save [--dataset houses-train#3000:3003] [--episodes 10]
     python benchmarks/eval_scaling.py memory [--scene small_house/scene.glb]
     python benchmarks/eval_scaling.py server [--workers 16] [--capacity 8] [--latency-s 0.5]

`workers` runs the same episodes with one worker and with two and prints rate, ratio and peak
memory. `save` prints what pages and videos cost, in processor time. `memory` prints what a worker's
memory is for, stage by stage (Linux). `server` starts a simulated
model server, on which every answer takes a fixed time and only so many are worked on at once, and
prints how busy many concurrent episodes keep it.
"""

import gc
import json
import tempfile
import threading
import time
from contextlib import closing
from dataclasses import dataclass, field, replace
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import get_args

import numpy as np
import tyro

from hypernav.app.build.agents import build_agent
from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.data.datasets import load_episodes, select
from hypernav.app.build.data.scenes import load_scene
from hypernav.app.build.presets import HyPerNavConfig, preset
from hypernav.core.episode import Episode
from hypernav.core.goal import Goal
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.lab.evaluation.choices import SaveChoice
from hypernav.lab.evaluation.runner import RunProgress, run_episodes
from hypernav.lab.evaluation.store.run_store import RunStore
from hypernav.lab.evaluation.workers.job import Job
from hypernav.lab.evaluation.workers.process_pool import ProcessPool
from hypernav.lab.evaluation.workers.worker import EpisodeWorker
from hypernav.lab.evaluation.workers.worker_pool import cpu_seconds_of_ended_workers
from hypernav.simulator.worlds.simulation import SimulatedWorld
from hypernav.simulator.worlds.surface.goal_regions import random_start

MODEL = "Qwen/Qwen2.5-VL-7B-Instruct"


@dataclass
class ModelServer:
    """An OpenAI-compatible server with empty answers, a fixed latency and a record of its load."""

    latency_s: float = 0.5
    capacity: int = 8
    address: str = ""
    _changes: list[tuple[float, int, int]] = field(default_factory=list)
    _working: int = 0
    _pending: int = 0

    def __enter__(self) -> "ModelServer":
        """Start the server."""
        self._slots = threading.BoundedSemaphore(self.capacity)
        self._lock = threading.Lock()
        self._server = ThreadingHTTPServer(("127.0.0.1", 0), self._handler())
        self._server.daemon_threads = True
        self.address = f"openai:http://127.0.0.1:{self._server.server_port}/v1#{MODEL}"
        self._thread = threading.Thread(target=self._server.serve_forever, daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *error: object) -> None:
        """Stop the server."""
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()

    def answer(self) -> None:
        """Wait for a free slot of the batch, then for the answer."""
        self._note(working=0, pending=1)
        with self._slots:
            self._note(working=1, pending=0)
            time.sleep(self.latency_s)
            self._note(working=-1, pending=-1)

    def busy_share(self, clients: int, until: float) -> float:
        """Mean share of busy slots, from the moment when all clients had asked until a time."""
        with self._lock:
            changes = list(self._changes)
        first = next((t for t, _, pending in changes if pending >= clients), None)
        if first is None or until <= first:
            return 0.0
        worked, last, working = 0.0, first, 0
        for moment, now_working, _ in [*changes, (until, 0, 0)]:
            moment = min(max(moment, first), until)
            worked += working * (moment - last)
            last, working = moment, now_working
        return worked / (self.capacity * (until - first))

    def _note(self, *, working: int, pending: int) -> None:
        with self._lock:
            self._working += working
            self._pending += pending
            self._changes.append((time.monotonic(), self._working, self._pending))

    def _handler(self) -> type[BaseHTTPRequestHandler]:
        server = self

        class Handler(BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"

            def do_GET(self) -> None:
                self._say({"object": "list", "data": [{"id": MODEL, "object": "model"}]})

            def do_POST(self) -> None:
                self.rfile.read(int(self.headers["Content-Length"]))
                server.answer()
                message = {"role": "assistant", "content": "[]"}
                choice = {"index": 0, "message": message, "finish_reason": "stop"}
                usage = {"prompt_tokens": 400, "completion_tokens": 2, "total_tokens": 402}
                said = {"id": "0", "object": "chat.completion", "created": 0, "model": MODEL}
                self._say(said | {"choices": [choice], "usage": usage})

            def _say(self, content: object) -> None:
                body = json.dumps(content).encode()
                self.send_response(200)
                self.send_header("Content-Type", "application/json")
                self.send_header("Content-Length", str(len(body)))
                self.end_headers()
                self.wfile.write(body)

            def log_message(self, format: str, *args: object) -> None:
                """Say nothing."""

        return Handler


def run(
    dataset: str,
    count: int,
    workers: int,
    config: HyPerNavConfig,
    specs: ComponentSpecs | None = None,
    *,
    max_steps: int = 500,
) -> tuple[RunProgress, list[float]]:
    """Run episodes; return the state at the end and the time at which each was done."""
    chosen = select(load_episodes(dataset, config.world, config.embodiment), part=f"0:{count}")
    episodes = [replace(episode, max_steps=max_steps) for episode in chosen]
    moments: list[float] = []

    def watch(progress: RunProgress) -> None:
        moments.extend([time.monotonic()] * (progress.done_now - len(moments)))

    with tempfile.TemporaryDirectory() as folder:
        job = Job(Path(folder), config, specs or ComponentSpecs())
        with RunStore(Path(folder), {"benchmark": "scaling"}) as store:
            progress = run_episodes(episodes, store, ProcessPool(job), workers=workers, watch=watch)
    return progress, moments


def workers(dataset: str = "houses-train#3000:3004", episodes: int = 16) -> None:
    """Compare one worker and two.

    Args:
        dataset: Name of a data set as for `hypernav eval`; not one that results are reported on.
        episodes: Number of episodes.
    """
    rates = {}
    for count in (1, 2):
        used = cpu_seconds_of_ended_workers()
        progress, moments = run(dataset, episodes, count, preset("default"))
        # From the first result until workers begin to run out of work: neither start nor end.
        last = max(len(moments) - count, 1)
        rates[count] = 3600.0 * last / (moments[last] - moments[0])
        peak = max(progress.peak_mb.values())
        steps = sum(record.steps for record in progress.records) / len(progress.records)
        print(
            f"{count} worker(s): {rates[count]:.0f} episodes an hour, once it runs; "
            f"{steps:.0f} steps an episode, peak memory of a worker {peak:.0f} MB, "
            f"{(cpu_seconds_of_ended_workers() - used) / episodes:.1f} s of processor an episode"
        )
    print(f"two workers are {rates[2] / rates[1]:.2f} times as fast as one")


def save(dataset: str = "houses-train#3000:3003", episodes: int = 10) -> dict[SaveChoice, float]:
    """Measure the processor time of the same episodes with every choice of what is saved.

    Args:
        dataset: Name of a data set as for `hypernav eval`.
        episodes: Number of episodes.

    Returns:
        Milliseconds of processor time per step, once everything is compiled.
    """
    config = preset("default")
    chosen = select(load_episodes(dataset, config.world, config.embodiment), part=f"0:{episodes}")
    costs: dict[SaveChoice, float] = {}
    with tempfile.TemporaryDirectory() as folder:
        warm_up = EpisodeWorker(Job(Path(folder), config, save="videos"))
        warm_up.run(replace(chosen[0], max_steps=20))
        warm_up.close()
        for choice in get_args(SaveChoice)[::-1]:
            worker = EpisodeWorker(Job(Path(folder), config, save=choice))
            began = time.process_time()
            records = [worker.run(episode) for episode in chosen]
            used = time.process_time() - began
            worker.close()
            steps = sum(record.steps for record in records)
            failed = [record.steps for record in records if not record.success]
            costs[choice] = 1000.0 * used / steps
            ratio = costs[choice] / costs["none"]
            print(
                f"--save {choice}: {costs[choice]:.1f} ms a step, {ratio:.2f} times none; "
                f"{len(failed)} of {len(records)} episodes failed, with "
                f"{sum(failed)} of {steps} steps"
            )
    return costs


def memory(scene: str = "houses:1000", steps: int = 30) -> None:
    """Measure the memory of a process that searches as a worker does, after every stage.

    What the program and the search take is a worker's beyond its scene.

    Args:
        scene: The building, as for `hypernav find --scene`.
        steps: Number of steps of the search.
    """
    stages = {"the program": proportional_mb()}
    config = preset("default")
    world = SimulatedWorld(load_scene(scene), config.world, config.embodiment)
    rng = np.random.default_rng(0)
    start = random_start(world.walkable, rng)
    episode = Episode(scene, "", Goal("unicorn"), start, max_steps=steps)
    world.reset(episode)  # draws the first image, for which textures and light are prepared
    stages["the scene"] = proportional_mb()
    parts = build_agent(config)
    with closing(parts), closing(world):
        for _ in EpisodeRun(parts.agent, world, episode, rng=rng):
            pass
        stages[f"{steps} steps of a search"] = proportional_mb()
    before = 0.0
    for stage, taken in stages.items():
        print(f"{stage}: {taken - before:.0f} MB more, {taken:.0f} in all")
        before = taken


def proportional_mb() -> float:
    """Memory of this process, megabytes; of what processes share, its part."""
    gc.collect()
    lines = Path("/proc/self/smaps_rollup").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("Pss:")) / 1024.0


def server(
    workers: int = 16,
    capacity: int = 8,
    latency_s: float = 0.5,
    dataset: str = "houses-train#3000:3004",
    episodes: int = 48,
    max_steps: int = 40,
    small: bool = False,
) -> float:
    """Measure how busy concurrent episodes keep a model server.

    Args:
        workers: Number of concurrent episodes.
        capacity: Number of questions that the server answers concurrently.
        latency_s: Time that an answer takes, seconds.
        dataset: Name of a data set as for `hypernav eval`.
        episodes: Number of episodes.
        max_steps: Maximum number of steps of each episode.
        small: Use a small camera, for machines that are busy with other things.

    Returns:
        The busy share, 0 to 1.
    """
    config = preset("paper")
    if small:
        values = config.model_dump()
        values["embodiment"]["camera"] |= {"width": 160, "height": 120}
        config = HyPerNavConfig.model_validate(values)
    with ModelServer(latency_s, capacity) as model:
        specs = ComponentSpecs(vlm=model.address, reasoner="geometric")
        progress, moments = run(dataset, episodes, workers, config, specs, max_steps=max_steps)
        # From then on fewer episodes are left than there are workers.
        share = model.busy_share(workers, until=moments[len(moments) - workers])
    calls = sum(record.model_calls for record in progress.records)
    print(f"{workers} episodes at a time, {calls} questions: the server was busy {share:.1%}")
    return share


if __name__ == "__main__":
    tyro.extras.subcommand_cli_from_dict(
        {"workers": workers, "save": save, "memory": memory, "server": server}
    )
