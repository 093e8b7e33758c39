"""Size and processor time of recorded views: python benchmarks/views.py [SCENE] [GOAL]."""

import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from hypernav.app.build.agents import build_agent
from hypernav.app.build.data.scenes import load_scene
from hypernav.app.build.presets import preset
from hypernav.app.show.video_frame import EpisodeInfo
from hypernav.app.show.viewers.foxglove_view import McapView
from hypernav.app.show.viewers.rerun_view import RrdView
from hypernav.core.episode import Episode
from hypernav.core.goal import Goal
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.simulator.worlds.simulation import SimulatedWorld
from hypernav.simulator.worlds.surface.goal_regions import random_start


def main(scene: str = "houses:7", text: str = "plant") -> None:
    config, goal, rng = preset("default"), Goal(text), np.random.default_rng(3)
    world = SimulatedWorld(load_scene(scene), config.world, config.embodiment)
    start = random_start(world.walkable, rng, world.regions.of(goal))
    info = EpisodeInfo(text, "hypernav")
    with tempfile.TemporaryDirectory() as folder:
        paths = {"rrd": Path(folder) / "a.rrd", "mcap": Path(folder) / "a.mcap"}
        views = {"rrd": RrdView(paths["rrd"], info), "mcap": McapView(paths["mcap"], info)}
        spent, steps = dict.fromkeys(views, 0.0), 0
        for step in EpisodeRun(build_agent(config).agent, world, Episode(scene, "", goal, start)):
            steps += 1
            for name, view in views.items():
                began = time.process_time()
                view.add(step.trace, step.grid, step.observation)
                spent[name] += time.process_time() - began
        for name, view in views.items():
            view.close()
            size = paths[name].stat().st_size / 1e6
            print(
                f"{name}: {steps} steps, {size:.1f} MB, {1000 * spent[name] / steps:.1f} ms a step"
            )


if __name__ == "__main__":
    main(*sys.argv[1:])
