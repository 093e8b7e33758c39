"""Workers as processes on this machine, one core each."""

import gc
import logging
import multiprocessing
import os
import signal
import sys
import tempfile
import threading
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from multiprocessing.resource_tracker import ensure_running
from pathlib import Path
from types import FrameType
from typing import NoReturn

from hypernav.app.build.components.choosing import choose_components
from hypernav.core.episode import Life
from hypernav.core.errors import ComponentError, HyPerNavError
from hypernav.core.interruptions import interruptions_of_kernels
from hypernav.lab.evaluation.workers.job import Job, factory_name
from hypernav.lab.evaluation.workers.worker_pool import (
    Crashed,
    Done,
    Lost,
    Ready,
    Refused,
    Report,
    peak_memory_mb,
)


def own_components(job: Job) -> list[str]:
    """Names of the components of a user's own in a job; none if all are of this package."""
    if job.make_agent is not None:
        return [factory_name(job.make_agent)]
    chosen = choose_components(job.specs, presence=job.config.presence.enabled).by_kind
    return [f"--{kind} {one.spec}" for kind, one in chosen.items() if one.entry.is_foreign]


ONE_THREAD = {
    name: "1"
    for name in ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
}
_LOGGER = logging.getLogger(__name__)
_PYTHON_FAILED = 1
_COMPONENT_FAILED = 76
_FAULTS = (signal.SIGSEGV, signal.SIGBUS, signal.SIGILL, signal.SIGFPE, signal.SIGABRT)
"""Signals by which a program's own mistake ends it; others come from outside."""
_TERMINATE_TIMEOUT_S = 5.0


@dataclass(frozen=True)
class _Process:
    process: BaseProcess
    pipe: Connection
    log: Path

    def said(self) -> str:
        """The end of the process's standard error."""
        return self.log.read_text(errors="replace")[-4000:].strip()


class ProcessPool:
    """A `WorkerPool` of processes that end when their owner does."""

    def __init__(self, job: Job) -> None:
        """Create it; no worker is started yet."""
        self._job = job
        self._context = multiprocessing.get_context("spawn")
        self._logs = tempfile.TemporaryDirectory(prefix="hypernav-workers-")
        self._started: dict[int, _Process] = {}
        self._warned: set[str] = set()

    def start(self, worker: int) -> None:
        """Start a worker."""
        ours, theirs = self._context.Pipe()
        log = Path(self._logs.name) / f"{worker}.log"
        log.write_bytes(b"")
        process = self._context.Process(
            target=_work, args=(self._job, theirs, log), name=f"hypernav-worker-{worker}"
        )
        with _interruptions_put_off(), _environment(ONE_THREAD), _ctrl_c_blocked():
            process.start()
            # If our copy of their end stayed open, the end of the worker would not be noticed.
            theirs.close()
            self._started[worker] = _Process(process, ours, log)

    def send(self, worker: int, life: Life) -> None:
        """Send an idle worker a life."""
        try:
            self._started[worker].pipe.send(life)
        except OSError:
            return  # It has ended; `wait` reports that.

    def wait(self, seconds: float) -> list[Report]:
        """The reports since the last call."""
        pipes = {started.pipe: worker for worker, started in self._started.items()}
        ready = wait(list(pipes), timeout=seconds)
        return [self._report(pipes[pipe]) for pipe in ready if isinstance(pipe, Connection)]

    def close(self) -> None:
        """End all workers."""
        for started in self._started.values():
            started.process.terminate()
        for started in self._started.values():
            started.process.join(_TERMINATE_TIMEOUT_S)
            if started.process.is_alive():
                started.process.kill()
                started.process.join()
            started.pipe.close()
        self._started.clear()
        self._logs.cleanup()

    def _report(self, worker: int) -> Report:
        started = self._started[worker]
        try:
            # What a worker sent before it died is still in the pipe.
            said = started.pipe.recv()
        except (EOFError, OSError):
            return self._report_of_ended(worker)
        match said:
            case str():
                return Refused(worker, said)
            case (list() as records, peak_mb, warnings):
                for warning in warnings:
                    if warning not in self._warned:
                        self._warned.add(warning)
                        _LOGGER.warning("%s", warning)
                return Done(worker, records, peak_mb)
            case _:
                return Ready(worker)

    def _report_of_ended(self, worker: int) -> Report:
        started = self._started.pop(worker)
        started.process.join()
        started.pipe.close()
        code = started.process.exitcode
        own = " or ".join(own_components(self._job))
        if code is not None and code < 0:
            killed = f"killed by signal {-code} ({_signal_name(-code)})"
            if not own or -code not in _FAULTS:
                return Lost(worker, killed)
            return Crashed(worker, f"{own}: its process was {killed}", is_own=True)
        said = started.said()
        if code == _PYTHON_FAILED and "Traceback" in said:
            return Crashed(worker, said)
        if code != _COMPONENT_FAILED:
            said += (
                f"\n{own or 'native code'}: ended the process of a worker with status {code}, as "
                "os._exit does"
            )
        return Crashed(worker, said, is_own=True)


def _work(job: Job, pipe: Connection, log: Path) -> None:
    """Run lives in a worker's process.

    It sends None when it is ready, records with the warnings that came with them, and a message if
    the run can't go on.
    """
    # imported here: the owner of the pool needs neither agents nor simulator
    from hypernav.lab.evaluation.workers.worker import EpisodeWorker

    gc.freeze()  # what was imported is no garbage; the last search among it would take the longest
    _die_with_owner()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # for systems where it cannot be blocked
    signal.signal(signal.SIGTERM, _leave)  # leaving by an exception closes scene and agent
    os.dup2(os.open(log, os.O_WRONLY | os.O_APPEND), sys.stderr.fileno())
    warnings = _Warnings(logging.WARNING)
    logging.getLogger("hypernav").addHandler(warnings)
    try:
        with interruptions_of_kernels(), closing(EpisodeWorker(job)) as episode_worker:
            _send(pipe, None)
            while True:
                records = episode_worker.live(_receive(pipe))
                _send(pipe, (records, peak_memory_mb(), warnings.said))
                warnings.said = []
    except KeyboardInterrupt:
        return  # the owner closes the pool
    except ComponentError as error:
        print(error.details, error, sep="\n", file=sys.stderr)
        sys.exit(_COMPONENT_FAILED)
    except HyPerNavError as error:
        _send(pipe, str(error))


class _Warnings(logging.Handler):
    """Keeps warnings, for the owner to show: nobody reads the standard error of a worker."""

    def __init__(self, level: int) -> None:
        super().__init__(level)
        self.said: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        """Keep a warning."""
        self.said.append(record.getMessage())


def _send(pipe: Connection, said: object) -> None:
    """Send something to the owner; end if the owner has ended."""
    try:
        pipe.send(said)
    except BrokenPipeError:
        sys.exit(0)


def _receive(pipe: Connection) -> Life:
    """The next life; end if the owner has ended."""
    try:
        return pipe.recv()
    except EOFError:
        sys.exit(0)


def _leave(_signal: int, _frame: FrameType | None) -> NoReturn:
    """End this process, and close what is open. `SystemExit` would look like a component's."""
    raise KeyboardInterrupt


def _die_with_owner() -> None:
    """End this process as soon as its owner ends, even if the owner is killed."""
    owner = multiprocessing.parent_process()
    if owner is None:
        return

    def watch() -> None:
        wait([owner.sentinel])
        os._exit(0)

    threading.Thread(target=watch, daemon=True, name="watch-owner").start()


@contextmanager
def _environment(values: dict[str, str]) -> Iterator[None]:
    """Set environment variables for processes that are started in the block."""
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


@contextmanager
def _interruptions_put_off() -> Iterator[None]:
    """Let the block finish: a worker that is half started would not be ended by `close`."""
    if threading.current_thread() is not threading.main_thread():
        yield  # Python raises interruptions in the main thread only
        return
    came: list[int] = []
    numbers = (signal.SIGINT, signal.SIGTERM)
    before = [signal.signal(number, lambda one, _: came.append(one)) for number in numbers]
    try:
        yield
    finally:
        for number, handler in zip(numbers, before, strict=True):
            signal.signal(number, handler)
    if came:
        signal.raise_signal(came[0])


@contextmanager
def _ctrl_c_blocked() -> Iterator[None]:
    """Block Ctrl-C for processes that are started in the block: their owner handles it.

    They inherit the mask. Ctrl-C during their imports would print a traceback on the terminal.
    """
    if sys.platform == "win32":
        yield
        return
    ensure_running()  # with the first process it would be started, and unblock Ctrl-C behind us
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _signal_name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return "unknown"
