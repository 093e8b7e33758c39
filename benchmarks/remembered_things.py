"""How many of the things that a search with a detector remembers are what it takes them for.

Run: python benchmarks/remembered_things.py --detector yolox:yolox_nano.onnx --houses 3100 3108

In every house one search looks in vain for something that is not there, and so sees most of it. A
thing is right if its middle lies in the box of an object of that name, or at most 0.4 m beside it,
as seen from above.
"""

from collections.abc import Callable
from contextlib import closing
from dataclasses import replace

import numpy as np
import tyro

from hypernav.app.build.agents import build_agent
from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.data.datasets import load_episodes
from hypernav.app.build.data.scenes import load_scene
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.goal import Goal
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.search.memory.memory import Memory
from hypernav.search.memory.thing import Thing
from hypernav.simulator.worlds.simulation import SimulatedWorld

_BESIDE_M = 0.4
Judged = list[tuple[Thing, bool]]


def main(
    detector: str, houses: tuple[int, int] = (3100, 3108), goal: str = "airplane", steps: int = 220
) -> None:
    """Print the share of right things by score, by how often they were overlooked, and by chance.

    Args:
        detector: Detector.
        houses: First building of houses-train, and the one after the last.
        goal: Something that no house has and the detector has a name for.
        steps: Number of steps of a search.
    """
    config = HyPerNavConfig()
    judged: Judged = []
    with closing(build_agent(config, ComponentSpecs(detector=detector))) as built:
        for number in range(*houses):
            first = load_episodes(f"houses-train#{number}:{number + 1}")[0]
            episode = replace(first, goal=Goal(goal), max_steps=steps)
            scene = load_scene(f"houses:{number}")
            with closing(SimulatedWorld(scene, config.world, config.embodiment)) as world:
                memory = Memory(config.mapping, config.embodiment)
                for _ in EpisodeRun(built.agent, world, episode, memory=memory):
                    pass
                judged += [(one, _is_right(one, world)) for one in memory.floor.things.known]
    print(f"{len(judged)} things, {sum(right for _, right in judged)} of them right")
    _print("score", judged, lambda one: one.score, (0.4, 0.5, 0.6, 0.7, 0.8, 0.9))
    _print("detected in", judged, lambda one: one.seen / (one.seen + one.overlooked), (0.5, 0.9))
    _print("chance", judged, lambda one: one.chance, (0.1, 0.25, 0.5, 0.75))


def _is_right(thing: Thing, world: SimulatedWorld) -> bool:
    x, y, _ = world.map_to_scene.apply(np.array([thing.position]))[0]
    return any(
        one.label is not None
        and one.label.satisfies(Goal(thing.label))
        and one.box_min[0] - _BESIDE_M <= x <= one.box_max[0] + _BESIDE_M
        and one.box_min[1] - _BESIDE_M <= y <= one.box_max[1] + _BESIDE_M
        for one in world.instances
    )


def _print(
    name: str, judged: Judged, value: Callable[[Thing], float], edges: tuple[float, ...]
) -> None:
    print(f"{name:>12}  things  right")
    for low, high in zip((0.0, *edges), (*edges, 1.01), strict=True):
        among = [right for one, right in judged if low <= value(one) < high]
        if among:
            print(f"{low:5.2f} to {min(high, 1.0):4.2f}  {len(among):6}  {np.mean(among):5.2f}")


if __name__ == "__main__":
    tyro.cli(main)
