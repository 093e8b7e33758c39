"""What a memory costs in a step: processor time of the agent alone, with and without a memory.

Run: python benchmarks/memory_steps.py --houses 3000 3003 --goals 4

Every house is a life: the memory is kept from goal to goal. Both agents start at the starts of the
same episodes, and the drawing of the simulator is not counted. With a memory that has been kept a
search is shorter, and turns and looks less between its choices; so each episode is also searched
with a new memory, which takes the same steps as without one.
"""

import itertools
import time
from collections.abc import Callable
from contextlib import closing

import numpy as np
import tyro

from hypernav.app.build.agents import build_agent
from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.data.datasets import load_episodes
from hypernav.app.build.data.scenes import load_scene
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.embodiment import Action
from hypernav.core.episode import Episode
from hypernav.search.agents.search import SearchAgent
from hypernav.search.memory.key_images import KeyImages
from hypernav.search.memory.memory import Memory
from hypernav.simulator.worlds.simulation import SimulatedWorld


def main(houses: tuple[int, int] = (3000, 3003), goals: int = 4, steps: int = 120) -> None:
    """Print the time of a step with and without a memory, and what the memory holds.

    Args:
        houses: First building of houses-train, and the one after the last.
        goals: Number of goals of a life.
        steps: Number of steps after which a search is ended.
    """
    config = HyPerNavConfig()
    without, with_new, with_memory = list[float](), list[float](), list[float]()
    for number in range(*houses):
        episodes = load_episodes(f"houses-train#{number}:{number + 1}")
        wanted = {one.goal.text: one for one in reversed(episodes)}
        memory = _new_memory(config)
        with closing(
            SimulatedWorld(load_scene(f"houses:{number}"), config.world, config.embodiment)
        ) as world:
            frame = None
            for episode in itertools.islice(wanted.values(), goals):
                world.keep_map_frame(frame)
                with_memory += _timed(config, world, episode, memory, steps)
                frame = world.map_to_scene
                world.keep_map_frame(None)
                without += _timed(config, world, episode, None, steps)
                with_new += _timed(config, world, episode, _new_memory(config), steps)
        things = sum(len(floor.things.known) for floor in memory.floors)
        assert memory.images is not None
        print(f"{number}: {things} things, {len(memory.images.kept)} key images", flush=True)
    for name, of in _STATISTICS.items():
        a, b, c = of(with_memory), of(without), of(with_new)
        print(f"{name}: {a:.2f} ms with memory, {b:.2f} ms without ({a / b:.2f} times), ", end="")
        print(f"{c:.2f} ms with a new one ({c / b:.2f} times)")
    same = float(np.median(np.divide(with_new, without)))
    print(f"one step with a new memory and without, median: {same:.2f} times")
    print(f"{len(with_memory)}, {len(without)} and {len(with_new)} steps")


_STATISTICS: dict[str, Callable[[list[float]], float]] = {
    "mean": lambda ms: float(np.mean(ms)),
    "median": lambda ms: float(np.median(ms)),
    "95 %": lambda ms: float(np.percentile(ms, 95.0)),
}


def _new_memory(config: HyPerNavConfig) -> Memory:
    return Memory(config.mapping, config.embodiment, images=KeyImages(50_000_000))


def _timed(
    config: HyPerNavConfig,
    world: SimulatedWorld,
    episode: Episode,
    memory: Memory | None,
    steps: int,
) -> list[float]:
    """Processor time of every step of the agent, milliseconds."""
    agent = build_agent(config, ComponentSpecs()).agent
    assert isinstance(agent, SearchAgent)
    observation = world.reset(episode, None)
    agent.reset(episode.goal, memory)
    times = list[float]()
    while len(times) < steps:
        began = time.process_time()
        action = agent.act(observation)
        times.append(1000.0 * (time.process_time() - began))
        if action in (None, Action.STOP):
            break
        observation = world.step(action)
    return times


if __name__ == "__main__":
    tyro.cli(main)
