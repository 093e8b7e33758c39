"""Workers as actors on a Ray cluster (extra ``ray``).

Records come back to the owner, who alone writes them. Houses are generated on the machine that
needs them; files of scenes and models must have the same path on every machine.
"""

import os
import socket
from dataclasses import replace
from typing import Any

from hypernav.core.components.registry import require
from hypernav.core.episode import Life
from hypernav.core.errors import ComponentError, HyPerNavError, RunFolderError
from hypernav.lab.evaluation.record import EpisodeRecord
from hypernav.lab.evaluation.workers.job import Job
from hypernav.lab.evaluation.workers.process_pool import ONE_THREAD
from hypernav.lab.evaluation.workers.worker_pool import (
    Crashed,
    Done,
    Lost,
    Ready,
    Refused,
    Report,
    peak_memory_mb,
)

_CONNECT_TIMEOUT_S = 5.0


class RayPool:
    """A `WorkerPool` of Ray actors, one core each."""

    def __init__(self, job: Job, address: str) -> None:
        """Connect to a cluster.

        Args:
            job: The job of every worker.
            address: ``HOST:PORT`` of the cluster's head, or ``auto`` for that of this machine.

        Raises:
            MissingExtraError: Ray is not installed.
            RunFolderError: Episodes would be saved on other machines.
            HyPerNavError: There is no cluster.
        """
        if job.save != "none":
            raise RunFolderError(
                "--save keeps videos on the machine that runs an episode, so it can't be used "
                "with --ray; run the interesting episodes again with local workers"
            )
        self._ray: Any = require("ray", extra="ray")
        try:
            _check_address(address)
            self._connects = not self._ray.is_initialized()
            self._ray.init(
                address=address,
                ignore_reinit_error=True,
                logging_level="error",
                log_to_driver=False,
            )
        except (OSError, ValueError) as error:
            raise HyPerNavError(
                f"--ray {address}: no Ray cluster answers there ({error}); start one with "
                "`ray start --head`, or leave --ray out to use this machine's cores"
            ) from error
        self._job = job
        self._actors: dict[int, Any] = {}
        self._waiting: dict[Any, int] = {}

    def start(self, worker: int) -> None:
        """Start a worker."""
        actor_class = self._ray.remote(num_cpus=1, max_restarts=0, runtime_env=_environment())(
            _Worker
        )
        actor = actor_class.remote(self._job)
        self._actors[worker] = actor
        self._waiting[actor.begin.remote()] = worker

    def send(self, worker: int, life: Life) -> None:
        """Send an idle worker a life."""
        self._waiting[self._actors[worker].live.remote(life)] = worker

    def wait(self, seconds: float) -> list[Report]:
        """The reports since the last call."""
        waiting = list(self._waiting)
        ready, _ = self._ray.wait(waiting, num_returns=len(waiting), timeout=0)
        if not ready:
            ready, _ = self._ray.wait(waiting, num_returns=1, timeout=seconds)
        return [self._report(answer, self._waiting.pop(answer)) for answer in ready]

    def close(self) -> None:
        """End all workers and leave the cluster, which keeps running."""
        for actor in self._actors.values():
            self._ray.kill(actor)
        self._actors.clear()
        self._waiting.clear()
        if self._connects:
            self._ray.shutdown()

    def _report(self, answer: Any, worker: int) -> Report:
        errors = self._ray.exceptions
        try:
            said = self._ray.get(answer)
        except (errors.RayActorError, errors.ObjectLostError) as error:
            self._actors.pop(worker, None)
            return Lost(worker, " ".join(str(error).split())[:200])
        except errors.RayTaskError as error:
            self._ray.kill(self._actors.pop(worker))
            return Crashed(worker, str(error))
        match said:
            case Crashed():
                self._ray.kill(self._actors.pop(worker))
                return replace(said, worker=worker)
            case str():
                return Refused(worker, said)
            case (records, peak_mb):
                return Done(worker, records, peak_mb)
            case _:
                return Ready(worker)


class _Worker:
    """The actor on the cluster. Returns None when ready, and a message if the run can't go on."""

    def __init__(self, job: Job) -> None:
        self._job = job

    def begin(self) -> str | Crashed | None:
        # imported here: the owner of the pool needs neither agents nor simulator
        from hypernav.lab.evaluation.workers.worker import EpisodeWorker

        try:
            self._episode_worker = EpisodeWorker(self._job)
        except ComponentError as error:
            return _crash_of(error)
        except HyPerNavError as error:
            return str(error)
        return None

    def live(self, life: Life) -> str | Crashed | tuple[list[EpisodeRecord], float]:
        try:
            return self._episode_worker.live(life), peak_memory_mb()
        except ComponentError as error:
            return _crash_of(error)
        except HyPerNavError as error:
            return str(error)

    def process_id(self) -> int:
        return os.getpid()

    def node(self) -> str:
        return require("ray", extra="ray").get_runtime_context().get_node_id()


def _crash_of(error: ComponentError) -> Crashed:
    """The report of an actor, which doesn't know its number."""
    return Crashed(-1, f"{error.details}\n{error}", is_own=True)


def _check_address(address: str) -> None:
    """Make sure that a cluster listens: Ray itself would keep trying for minutes.

    Raises:
        OSError: Nothing listens at the address.
        ValueError: The port is not a number.
    """
    host, colon, port = address.removeprefix("ray://").rpartition(":")
    if colon:
        socket.create_connection((host, int(port)), timeout=_CONNECT_TIMEOUT_S).close()


def _environment() -> dict[str, Any]:
    return {"env_vars": dict(ONE_THREAD)}
