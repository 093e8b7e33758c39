"""A first run on two cores: the agent's kernels are compiled beside those of the world.

Numba compiles a kernel where it is first called, once on a machine, and keeps it on disk. It holds
Python's global lock meanwhile, so that only another process can compile at the same time. While
this one builds and draws the world, that one lets an agent search an empty room, which needs no
world: it calls, and so compiles, what maps and plans.
"""

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from hypernav.build.agents import build_agent
from hypernav.build.presets import preset
from hypernav.core.goal import Goal
from hypernav.evaluation.checks.box_room import DOOR, BoxRoom
from hypernav.mapping.integrate_kernels import integrate_frame

FIRST_RUN = "first run: compiling for this machine, once, takes half a minute …"

_STEPS = 12


def is_compiled() -> bool:
    """Whether kernels were compiled on this machine before, as far as the first one tells."""
    folder = integrate_frame.stats.cache_path
    name = f"integrate_kernels.{integrate_frame.__name__}-*.nbi"
    return folder is not None and any(Path(folder).glob(name))


@contextmanager
def rehearsal(say: Callable[[str], object]) -> Iterator[None]:
    """Compile in another process beside the block; does nothing on a machine that has compiled.

    Nothing depends on that process: what it has not compiled in time is compiled in this one.

    Args:
        say: Is told that this run takes longer.
    """
    if is_compiled():
        yield
        return
    say(FIRST_RUN)
    if (os.cpu_count() or 1) < 2:
        yield
        return
    silent = subprocess.DEVNULL
    command = [sys.executable, "-m", "hypernav.evaluation.rehearsal"]
    with subprocess.Popen(command, stdin=silent, stdout=silent, stderr=silent) as process:
        try:
            yield
        finally:
            process.kill()


def rehearse() -> None:
    """Let the default agent look for the door of an empty room, and for what is not there."""
    agent = build_agent(preset("default")).agent
    for goal in (DOOR, "nothing of the kind"):
        room = BoxRoom()
        agent.reset(Goal(goal))
        for _ in range(_STEPS):
            action = agent.act(room.observe())
            if action is None:
                break
            room.step(action)


if __name__ == "__main__":
    rehearse()
