"""Time what a user waits for: help, the answer to a mistake, a first step, a finished page.

    python benchmarks/start.py --runs 10

Every measurement starts a real process. A first run gets empty caches, of numba and of houses.
"""

import os
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import tyro
from rich.console import Console
from rich.table import Table

HYPERNAV = (sys.executable, "-c", "from hypernav.cli.main import main; main()")
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


def seconds_of_find(environment: dict[str, str]) -> tuple[float, float]:
    """Seconds from Enter to the first step, and to the finished page."""
    with tempfile.TemporaryDirectory() as folder:
        trace = Path(folder) / "trace.jsonl"
        command = [*HYPERNAV, "find", "bed", "--quiet", "--out", folder]
        began = time.perf_counter()
        with subprocess.Popen(command, env={**os.environ, **environment}) as process:
            while process.poll() is None and not (trace.exists() and trace.stat().st_size):
                time.sleep(0.01)
            first_step = time.perf_counter() - began
        return first_step, time.perf_counter() - began


def seconds_of_first_find() -> tuple[float, float]:
    """Seconds of the same command with empty caches, of kernels and of houses."""
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder)
        return seconds_of_find(
            {"NUMBA_CACHE_DIR": str(home / "numba"), "HYPERNAV_CACHE": str(home / "houses")}
        )


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
    finds = Table("median seconds", "first step", "finished page")
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


if __name__ == "__main__":
    main()
