"""Whole command lines under limits, and what every one of them must keep to."""

import atexit
import functools
import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import cast

from hostile.preloaded import Request

_TESTS = Path(__file__).parents[1]
_ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "MALLOC_ARENA_MAX": "1"}
_PROGRAM = "from hypernav.app.cli.main import main; main()"
_CONTROL = re.compile(r"[\x00-\x09\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")


@dataclass(frozen=True)
class Ended:
    """How a command line ended.

    Attributes:
        request: What was run.
        status: Exit status, or the negative number of the signal that killed it.
        out: Standard output.
        err: Standard error.
        seconds: Wall-clock time; in a forked child, less what it waited for a core.
        peak_mb: Peak memory above that of a process that has only imported everything.
    """

    request: Request
    status: int
    out: str
    err: str
    seconds: float
    peak_mb: float


def run(
    arguments: Sequence[str | Path],
    folder: Path,
    *,
    environment: Mapping[str, str] | None = None,
    seconds: float = 10.0,
    memory_mb: float = 1000.0,
    file_mb: float | None = None,
) -> Ended:
    """Run ``hypernav`` with these arguments, in a child of a process that has imported all.

    Args:
        arguments: The command line without its first word.
        folder: Working folder.
        environment: Environment variables to set.
        seconds: Time limit.
        memory_mb: Memory limit.
        file_mb: Limit of a file's size; writing beyond it fails as on a full disk.
    """
    request = Request(
        [str(argument) for argument in arguments],
        str(folder),
        dict(environment or {}),
        seconds,
        memory_mb,
        file_mb,
    )
    parent = _parent()
    assert parent.stdin is not None
    assert parent.stdout is not None
    parent.stdin.write(json.dumps(asdict(request)) + "\n")
    parent.stdin.flush()
    return Ended(request, **json.loads(parent.stdout.readline()))


def start(
    arguments: Sequence[str | Path],
    folder: Path,
    *,
    environment: Mapping[str, str] | None = None,
) -> subprocess.Popen[str]:
    """Start ``hypernav`` as a process of its own, for what the first second and signals do."""
    return subprocess.Popen(
        [sys.executable, "-c", _PROGRAM, *(str(argument) for argument in arguments)],
        cwd=folder,
        env=os.environ | dict(environment or {}),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
        # A shell that runs tests in the background hands down SIGINT as ignored.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )


def wait(process: subprocess.Popen[str], seconds: float = 10.0) -> Ended:
    """The end of a process of its own; its memory isn't measured."""
    request = Request(cast("list[str]", process.args)[3:], "", {}, seconds)
    began = time.monotonic()
    try:
        out, err = process.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        process.kill()
        out, err = process.communicate()
    return Ended(request, process.returncode, out, err, time.monotonic() - began, 0.0)


def check(ended: Ended, status: int | Sequence[int], *words: str) -> None:
    """Assert what holds for every command line, whoever wrote it.

    Args:
        ended: How it ended.
        status: The exit status that it must have, or those that it may have.
        words: What its messages must contain.
    """
    said, about = ended.out + ended.err, _shown(ended)
    assert "Traceback (most recent call last)" not in said, about
    assert not _CONTROL.search(said), about
    assert ended.seconds < ended.request.seconds, about
    assert ended.peak_mb < ended.request.memory_mb, about
    assert ended.status in ([status] if isinstance(status, int) else status), about
    for word in words:
        assert word in said, about


def _shown(ended: Ended) -> str:
    line = " ".join(ascii(argument)[1:-1][:200] for argument in ended.request.arguments)
    return (
        f"hypernav {line}\nstatus {ended.status}, {ended.seconds:.1f} s, {ended.peak_mb:.0f} MB\n"
        f"{ended.out[-3000:]}{ended.err[-3000:]}"
    )


@functools.cache
def _parent() -> subprocess.Popen[str]:
    parent = subprocess.Popen(
        [sys.executable, "-m", "hostile.preloaded"],
        cwd=_TESTS,
        env=os.environ | _ONE_THREAD,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    atexit.register(_end, parent)
    return parent


def _end(parent: subprocess.Popen[str]) -> None:
    """Let the parent see that no further request comes."""
    with parent:
        assert parent.stdin is not None
        parent.stdin.close()
