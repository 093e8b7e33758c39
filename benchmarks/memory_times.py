"""What opening and saving a memory costs, in processor and wall-clock time.

Run: python benchmarks/memory_times.py home
     python benchmarks/memory_times.py home --beside ../before/src

A copy of the memory is opened, and saved after a change on every floor, so that all maps are
written. Another version of the package may be timed beside this one, in turns: a process each.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import tyro

import hypernav

_HERE = Path(hypernav.__file__).parents[1]
_COLUMNS = ("open, processor", "open, wall", "save, processor", "save, wall")
_OF_A_PROCESS = 5


def main(
    folder: Path, /, rounds: int = 15, beside: Path | None = None, prints_times: bool = False
) -> None:
    """Print medians in milliseconds, and of their ratios in each round.

    Args:
        folder: Folder of the memory.
        rounds: Number of rounds.
        beside: Folder with another version of the package, which can read the memory.
        prints_times: Only measure here, as a process of a round does.
    """
    if prints_times:
        print(json.dumps(_times_ms(folder)))
        return
    versions = [_HERE] if beside is None else [_HERE, beside]
    of_round = [[_measured_ms(folder, one) for one in versions] for _ in range(rounds)]
    times_ms = np.array(of_round)  # round, version, column
    for number, column in enumerate(_COLUMNS):
        medians = " and ".join(f"{one:.1f} ms" for one in np.median(times_ms[..., number], axis=0))
        ratios = times_ms[:, 0, number] / times_ms[:, -1, number]
        said = f", ratio {np.median(ratios):.3f}" if beside else ""
        print(f"{column:>16}: {medians}{said}")


def _measured_ms(folder: Path, version: Path) -> list[float]:
    command = [sys.executable, __file__, str(folder), "--prints-times"]
    environment = os.environ | {"PYTHONPATH": str(version.resolve())}
    return json.loads(subprocess.check_output(command, env=environment))


def _times_ms(folder: Path) -> list[float]:
    """Medians of a process, in which the first time of each is not counted."""
    rows, index = list[tuple[float, ...]](), json.loads((folder / "memory.json").read_text())
    config = hypernav.HyPerNavConfig(mapping=index["mapping"], embodiment=index["robot"])
    with tempfile.TemporaryDirectory() as place:
        home = shutil.copytree(folder, Path(place) / "home")
        for _ in range(1 + _OF_A_PROCESS):
            clocks = [(time.process_time(), time.perf_counter())]
            with hypernav.open_memory(home, config) as opened:
                clocks.append((time.process_time(), time.perf_counter()))
                for floor in opened.memory.floors:
                    floor.trajectory.append((0.0, 0.0))
                opened.save()
                clocks.append((time.process_time(), time.perf_counter()))
            rows.append(tuple(1e3 * np.diff(clocks, axis=0).ravel()))
    return np.median(rows[1:], axis=0).tolist()


if __name__ == "__main__":
    tyro.cli(main)
