"""Kill -9 at any moment of a life: does the memory open, and how old is the newest thing lost?

Run: python benchmarks/memory_kills.py --kills 30

A process of its own searches for one goal after the other in the built-in house, with a memory on
disk, and says after every step how much it knows. It is killed after a random time; then the memory
is opened, and the oldest step that it lacks tells how much was lost. The next process goes on.
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Literal

import numpy as np
import tyro

from hypernav.app.build.memories.building_memory import open_memory
from hypernav.app.build.search import find

_GOALS = ("bed", "sofa", "tv", "toilet", "chair")


def main(
    kills: int = 30,
    longest_s: float = 25.0,
    seed: int = 0,
    folder: Path | None = None,
    role: Literal["killer", "killed"] = "killer",
) -> None:
    """Print what every kill cost.

    Args:
        kills: Number of kills.
        longest_s: Longest time from the first step to a kill, seconds.
        seed: Seed of the times.
        folder: Folder of the memory; a new one unless given.
        role: The killer, or the process that it starts.
    """
    if role == "killed":
        assert folder is not None
        _search_for_ever(folder, seed)
    with tempfile.TemporaryDirectory() as place:
        home = folder or Path(place) / "home"
        rng = np.random.default_rng(seed)
        ages = [_lost_s(home, float(rng.uniform(0.0, longest_s)), k) for k in range(kills)]
    print(
        f"{kills} kills, the memory opened whole after each; lost: at most the last "
        f"{max(ages):.1f} s, median {np.median(ages):.1f} s"
    )


def _search_for_ever(folder: Path, seed: int) -> None:
    with open_memory(folder) as home:
        while True:
            goal = _GOALS[home.memory.searches % len(_GOALS)]
            for _ in find(goal, memory=home, seed=seed + home.memory.searches):
                print(time.time(), home.memory.searches, _known(home.memory), flush=True)


def _known(memory) -> int:
    """Number of frames in the present map."""
    return sum(len(floor.trajectory) for floor in memory.floors)


def _lost_s(home: Path, after_s: float, k: int) -> float:
    """Kill a process after a time, open the memory, and say how old the oldest lost step is."""
    arguments = ["--role", "killed", "--folder", str(home), "--seed", str(1000 * k)]
    with subprocess.Popen(
        [sys.executable, __file__, *arguments],
        stdout=subprocess.PIPE,
        env=os.environ,
    ) as process:
        assert process.stdout is not None
        lines = [process.stdout.readline()]
        time.sleep(after_s)
        process.kill()
        killed = time.time()
        lines += process.stdout.readlines()
    steps = [line.split() for line in lines if line.endswith(b"\n")]
    with open_memory(home) as opened:
        assert opened.left_out == (), opened.left_out
        kept = (opened.memory.searches, _known(opened.memory))
    lost = [float(at) for at, search, known in steps if (int(search), int(known)) > kept]
    age = killed - min(lost, default=killed)
    print(f"{k}: killed after {after_s:.1f} s and {len(steps)} steps, lost {age:.1f} s", flush=True)
    return age


if __name__ == "__main__":
    tyro.cli(main)
