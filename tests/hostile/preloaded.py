"""A process that has imported everything and forks a child for each command line.

Run as ``python -m hostile.preloaded``. Requests come in on standard input and replies go out on
standard output, one JSON object a line. A child leaves the loop, runs ``hypernav`` and ends as the
program does, with its exit hooks. Only Linux tells what the limits need.
"""

import atexit
import gc
import importlib
import json
import os
import pkgutil
import resource
import signal
import sys
import tempfile
import threading
import time
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any, NoReturn

_SPARE_MB = 2000
"""Address space beyond the limit of memory: a child shall be seen to exceed that, not fail."""

_POLL_S = 0.003
_LEFT_OUT = ("hypernav.app.show.viewers.rerun_", "hypernav.simulator.worlds.drawing.warp_")
"""Modules that import rerun, which starts threads, and Warp, which need not be installed; no
command here uses them."""


@dataclass(frozen=True)
class Request:
    """A command line, where it runs, and its limits.

    Attributes:
        arguments: The command line without its first word.
        folder: Working folder.
        environment: Environment variables that are set for it.
        seconds: Time limit; the child and what it started are killed then. Time that it waits for
            a core doesn't count.
        memory_mb: Memory limit above that of the parent.
        file_mb: Limit of a file's size; writing beyond it fails as on a full disk.
    """

    arguments: list[str]
    folder: str
    environment: dict[str, str] = field(default_factory=dict)
    seconds: float = 10.0
    memory_mb: float = 1000.0
    file_mb: float | None = None


def preload() -> None:
    """Import the whole package, and start nothing: a fork takes only one thread along."""
    import hypernav

    for module in pkgutil.walk_packages(hypernav.__path__, "hypernav."):
        if not module.name.startswith(_LEFT_OUT):
            importlib.import_module(module.name)
    for name in ("av", "cv2", "PIL.PngImagePlugin", "scipy.ndimage"):
        importlib.import_module(name)
    threads = os.listdir("/proc/self/task")
    if len(threads) > 1:
        raise RuntimeError(f"an import started {len(threads) - 1} threads; a fork would lose them")
    gc.freeze()


def serve() -> list[str] | None:
    """Answer requests until there are no more.

    Returns:
        None in the parent; in a child its command line.
    """
    for line in sys.stdin:
        request = Request(**json.loads(line))
        with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
            base_mb = _memory_mb("RssAnon")
            child = os.fork()
            if child == 0:
                _become(request, out, err)
                return request.arguments
            reply = _wait(child, request.seconds)
            reply["peak_mb"] -= base_mb
            print(json.dumps(reply | {"out": _text(out), "err": _text(err)}), flush=True)
    return None


def _become(request: Request, out: IO[bytes], err: IO[bytes]) -> None:
    """Make this child the process that the request describes."""
    os.setsid()
    for source, target in ((os.open(os.devnull, os.O_RDONLY), 0), (out.fileno(), 1)):
        os.dup2(source, target)
    os.dup2(err.fileno(), 2)
    os.chdir(request.folder)
    os.environ.update(request.environment)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    space_mb = _memory_mb("VmSize") + request.memory_mb + _SPARE_MB
    _limit(resource.RLIMIT_AS, space_mb)
    if request.file_mb is not None:
        _limit(resource.RLIMIT_FSIZE, request.file_mb)


def _wait(child: int, seconds: float) -> dict[str, Any]:
    """The end of a child, which comes by force after the time limit."""
    began = time.monotonic()
    taken, late = 0.0, False
    while not (ended := os.wait4(child, os.WNOHANG))[0]:
        taken = time.monotonic() - began - _starved_s(child)
        if not late and taken > seconds:
            late = True
            os.killpg(child, signal.SIGKILL)
        time.sleep(_POLL_S)
    _, status, usage = ended
    return {
        "status": os.waitstatus_to_exitcode(status),
        "seconds": taken,
        "peak_mb": usage.ru_maxrss / 1024,
    }


def _starved_s(process: int) -> float:
    """How long a process has waited for a core that others had: that isn't its fault, seconds."""
    with suppress(FileNotFoundError):
        return int(Path(f"/proc/{process}/schedstat").read_text().split()[1]) / 1e9
    return 0.0


def _limit(what: int, megabytes: float) -> None:
    size = int(megabytes * 2**20)
    resource.setrlimit(what, (size, size))


def _memory_mb(what: str) -> float:
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) / 1024 for line in lines if line.startswith(f"{what}:"))


def _text(file: IO[bytes]) -> str:
    file.seek(0)
    return file.read(1_000_000).decode(errors="replace")


def _run(arguments: list[str]) -> NoReturn:
    """Run the program to its end, without the teardown of modules: it takes the longest."""
    from hypernav.app.cli.main import main

    sys.argv = ["hypernav", *arguments]
    status = 0
    try:
        main()
    except SystemExit as stop:
        status = stop.code if isinstance(stop.code, int) else 1
    except BaseException as error:
        sys.excepthook(type(error), error, error.__traceback__)
        status = 1
    threading._shutdown()  # pyright: ignore[reportAttributeAccessIssue]
    atexit._run_exitfuncs()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)


if __name__ == "__main__":
    preload()
    command_line = serve()
    if command_line is not None:
        _run(command_line)
