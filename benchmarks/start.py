"""Time what a user waits for: help, the answer to a mistake, a first step, a finished page.

    python benchmarks/start.py --runs 10

Every measurement starts a real process. A first run gets empty caches, of numba and of houses; the
processor time of its helpers counts, too. The share of page and video is that of the processor
time within `Views.add` and `Views.finish`, imports included in the whole.
"""

import multiprocessing
import os
import statistics
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import tyro
from rich.console import Console
from rich.table import Table

HYPERNAV = (sys.executable, "-c", "from hypernav.app.cli.main import main; main()")
LIGHT = {
    "import hypernav": (sys.executable, "-c", "import hypernav"),
    "hypernav --help": (*HYPERNAV, "--help"),
    "hypernav find --help": (*HYPERNAV, "find", "--help"),
    "a wrong option": (*HYPERNAV, "find", "bed", "--sede", "3"),
}


@dataclass(frozen=True)
class Arguments:
    """The options of the benchmark.

    Attributes:
        runs: Number of runs of each measurement; medians are printed.
        first_runs: Number of runs with empty caches, which take much longer.
    """

    runs: int = 10
    first_runs: int = 3


def seconds(command: tuple[str, ...]) -> tuple[float, float]:
    """Wall-clock and processor seconds of a process."""
    before, began = os.times(), time.perf_counter()
    subprocess.run(command, capture_output=True, check=False)
    wall, after = time.perf_counter() - began, os.times()
    busy = after.children_user + after.children_system
    return wall, busy - before.children_user - before.children_system


def seconds_of_find(environment: dict[str, str]) -> tuple[float, float, float]:
    """Seconds from Enter to the first step, to the finished page, and of processor."""
    before = os.times()
    with tempfile.TemporaryDirectory() as folder:
        trace = Path(folder) / "trace.jsonl"
        command = [*HYPERNAV, "find", "bed", "--quiet", "--out", folder]
        began = time.perf_counter()
        with subprocess.Popen(command, env={**os.environ, **environment}) as process:
            while process.poll() is None and not (trace.exists() and trace.stat().st_size):
                time.sleep(0.01)
            first_step = time.perf_counter() - began
        page, after = time.perf_counter() - began, os.times()
    busy = after.children_user + after.children_system
    return first_step, page, busy - before.children_user - before.children_system


def seconds_of_first_find() -> tuple[float, float, float]:
    """Seconds of the same command with empty caches, of kernels and of houses."""
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder)
        return seconds_of_find(
            {"NUMBA_CACHE_DIR": str(home / "numba"), "HYPERNAV_CACHE": str(home / "houses")}
        )


def seconds_of_views() -> tuple[float, float]:
    """Processor seconds of this process after `hypernav find bed`, and of it page and video."""
    from hypernav.app.cli.main import main
    from hypernav.app.cli.screen.views import Views

    spent = []

    def timed(work):
        def run(*given):
            began = time.process_time()
            work(*given)
            spent.append(time.process_time() - began)

        return run

    for name in ("add", "finish"):
        setattr(Views, name, timed(getattr(Views, name)))
    with tempfile.TemporaryDirectory() as folder, suppress(SystemExit):
        main(["find", "bed", "--quiet", "--out", folder])
    return time.process_time(), sum(spent)


def main() -> None:
    """Measure and print a table."""
    arguments = tyro.cli(Arguments, description=__doc__)
    table = Table("median seconds", "wall clock", "processor")
    for name, command in LIGHT.items():
        seconds(command)
        runs = [seconds(command) for _ in range(arguments.runs)]
        table.add_row(
            name, *(f"{statistics.median(column):.2f}" for column in zip(*runs, strict=True))
        )
    finds = Table("median seconds", "first step", "finished page", "processor")
    seconds_of_find({})
    for name, runs in (
        ("hypernav find bed", [seconds_of_find({}) for _ in range(arguments.runs)]),
        ("first run", [seconds_of_first_find() for _ in range(arguments.first_runs)]),
    ):
        if runs:
            row = (f"{statistics.median(column):.1f}" for column in zip(*runs, strict=True))
            finds.add_row(name, *row)
    console = Console()
    console.print(table)
    console.print(finds)
    fresh = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=fresh, max_tasks_per_child=1) as processes:
        runs = [processes.submit(seconds_of_views).result() for _ in range(arguments.runs)]
    whole, views = (statistics.median(column) for column in zip(*runs, strict=True))
    console.print(f"page and video: {views:.2f} of {whole:.2f} processor s, {views / whole:.0%}")


if __name__ == "__main__":
    main()
