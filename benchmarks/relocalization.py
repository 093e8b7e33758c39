"""How often a robot with an unknown start finds its place in a memory, and how often it is wrong.

Run: python benchmarks/relocalization.py --houses 3006 3010
     python benchmarks/relocalization.py --houses 3006 3010 --kind offices

In each building a life of several goals is searched with true labels. A robot then stands at random
starts, with what is known after the first search and after the last, turns once around and says
where it is. It is right within 0.25 m and 5 degrees. The same turns in the building before tell how
often it takes another building for its own.
"""

import math
from collections import Counter
from dataclasses import dataclass

import numpy as np
import tyro

from hypernav.app.build.agents import build_agent
from hypernav.app.build.data.datasets import load_episodes
from hypernav.app.build.data.scenes import load_scene
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.episode import Episode
from hypernav.core.geometry.transforms import Transform, wrap_angle
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.lab.episodes.memory_frame import find_start
from hypernav.search.memory.memory import Memory
from hypernav.simulator.worlds.simulation import SimulatedWorld
from hypernav.simulator.worlds.surface.goal_regions import random_start

_NEAR_M, _NEAR_DEG = 0.25, 5.0


@dataclass(frozen=True)
class _Known:
    """What is known of a building: after how many searches, the memory, and its frame."""

    searches: str
    memory: Memory
    map_to_scene: Transform


def main(
    houses: tuple[int, int] = (3006, 3010),
    kind: str = "houses",
    goals: int = 6,
    starts: int = 12,
) -> None:
    """Print how often the place is right, wrong, or not clear.

    Args:
        houses: First building of the training split, and the one after the last.
        kind: Kind of building: houses or offices.
        goals: Number of goals of a life.
        starts: Number of starts in each building.
    """
    config, told, before = HyPerNavConfig(), Counter[tuple[str, str]](), list[_Known]()
    for number in range(*houses):
        rng = np.random.default_rng(number)
        with_goal = {one.goal.text: one for one in reversed(load_episodes(_split(kind, number)))}
        life = list(with_goal.values())[:goals]
        world = SimulatedWorld(load_scene(f"{kind}:{number}"), config.world, config.embodiment)
        known = _lived(world, life, config)
        for _ in range(starts):
            start = random_start(world.walkable, rng, world.regions.of(life[0].goal))
            episode = Episode(f"{kind}:{number}", "", life[0].goal, start)
            for one in known:
                told[one.searches, _judged(one, world, episode)] += 1
            for one in before:
                found, _ = find_start(one.memory, world, episode, None)
                told["another building", "don't know" if found.doubt else "wrong"] += 1
        before = known
        world.close()
        print(number, dict(told), flush=True)
    for case in dict.fromkeys(case for case, _ in told):
        counts = {word: told[case, word] for word in ("right", "wrong", "don't know")}
        print(f"{case}: {counts} of {sum(counts.values())}")


def _split(kind: str, number: int) -> str:
    return f"{kind}-train#{number}:{number + 1}"


def _lived(world: SimulatedWorld, life: list[Episode], config: HyPerNavConfig) -> list[_Known]:
    """What is known after the first and after the last search of a life."""
    built, memory, known = build_agent(config), Memory(config.mapping, config.embodiment), []
    for k, episode in enumerate(life):
        run = EpisodeRun(
            built.agent,
            world,
            episode,
            rng=np.random.default_rng(0),
            told=built.truth,
            goes_on=k > 0,
            memory=memory,
        )
        for _ in run:
            pass
        if k in (0, len(life) - 1):
            words = "after one search" if k == 0 else f"after {len(life)} searches"
            known.append(_Known(words, memory.copy(), world.map_to_scene))
    return known


def _judged(known: _Known, world: SimulatedWorld, episode: Episode) -> str:
    """Whether the place that the robot takes for its own is right."""
    found, _ = find_start(known.memory, world, episode, None)
    if found.doubt or found.place is None:
        return "don't know"
    true = known.map_to_scene.inverse() @ world.map_to_scene
    away_m = math.dist(true.translation, found.place.own_to_map.translation)
    turned_deg = math.degrees(abs(wrap_angle(true.yaw - found.place.own.yaw)))
    return "right" if away_m <= _NEAR_M and turned_deg <= _NEAR_DEG else "wrong"


if __name__ == "__main__":
    tyro.cli(main)
