"""Search for a bed in the built-in house and print the reason of every action.

Run: python examples/01_find_in_simulation.py [GOAL]
"""

import sys

import numpy as np

from hypernav.build.agents import build_agent
from hypernav.build.presets import preset
from hypernav.build.scenes import build_scene
from hypernav.core.episode import Episode
from hypernav.core.goal import Goal
from hypernav.worlds.episode_run import EpisodeRun
from hypernav.worlds.simulation import SimulatedWorld
from hypernav.worlds.surface.starts import random_start


def main() -> None:
    goal = Goal(sys.argv[1] if len(sys.argv) > 1 else "bed")
    config = preset("default")
    world = SimulatedWorld(build_scene("builtin"), config.world, config.embodiment)
    start = random_start(world.walkable, np.random.default_rng(0), world.regions.of(goal))

    episode = Episode("builtin", "0", goal, start)
    search = EpisodeRun(build_agent(config).agent, world, episode)
    for step in search:
        print(f"{step.trace.step:3d}  {step.trace.mode:12s} {step.trace.reason}")

    result = search.result()
    print(f"{result.outcome}: SPL {result.metrics.spl:.2f} in {result.steps} steps")


if __name__ == "__main__":
    main()
