"""What a memory is worth: goals of one building in a row, with the memory and with a fresh one.

Run: python benchmarks/memory_lives.py --houses 3000 3004 --goals 6
     python benchmarks/memory_lives.py --detector yolox:yolox_nano.onnx

Every goal starts where the search with memory for the one before ended, and both searches start
there. At the end the first goal is asked for once more, when much has been seen.
"""

import itertools
import time
from contextlib import closing
from dataclasses import replace

import numpy as np
import tyro

from hypernav.build.agents import build_agent
from hypernav.build.component_specs import ComponentSpecs
from hypernav.build.data.datasets import load_episodes
from hypernav.build.data.scenes import load_scene
from hypernav.build.presets import HyPerNavConfig
from hypernav.core.episodes.episode import Episode
from hypernav.core.errors import GoalError
from hypernav.episodes.episode_run import EpisodeResult, EpisodeRun
from hypernav.mapping.memory.memory import Memory
from hypernav.worlds.simulation import SimulatedWorld


def main(
    houses: tuple[int, int] = (3000, 3004), goals: int = 6, detector: str | None = None
) -> None:
    """Print SPL and steps with and without memory.

    Args:
        houses: First building of houses-train, and the one after the last.
        goals: Number of goals of a life.
        detector: Detector; true labels unless given.
    """
    config, specs = HyPerNavConfig(), ComponentSpecs(detector=detector)
    remembering, fresh = build_agent(config, specs), build_agent(config, specs)
    rows = list[tuple[int, float, float, bool, bool]]()
    for number in range(*houses):
        episodes = load_episodes(f"houses-train#{number}:{number + 1}")
        wanted = {one.goal.text: one for one in reversed(episodes)}
        life = list(
            itertools.islice(filter(lambda one: _can_find(fresh, one), wanted.values()), goals)
        )
        scene = load_scene(f"houses:{number}")
        with closing(SimulatedWorld(scene, config.world, config.embodiment)) as world:
            memory, frame, start = Memory(config.mapping, config.embodiment), None, life[0].start
            for k, episode in enumerate([*life, life[0]]):
                episode = replace(episode, start=start)
                world.keep_map_frame(frame)
                with_memory, ms = _searched(remembering, world, episode, memory)
                frame, start = world.map_to_scene, world.pose
                world.keep_map_frame(None)
                without, fresh_ms = _searched(fresh, world, episode, None)
                a, b = with_memory.metrics, without.metrics
                rows.append((k, a.spl, b.spl, a.success, b.success))
                print(
                    f"{number} {k} {episode.goal.text:16} SPL {a.spl:.2f} in {with_memory.steps} "
                    f"steps of {ms:.0f} ms, fresh {b.spl:.2f} in {without.steps} of {fresh_ms:.0f}",
                    flush=True,
                )
    _say("goals 2 and later", [one for one in rows if one[0] > 0])
    _say("the first goal again", [one for one in rows if one[0] == goals])


def _can_find(agent, episode: Episode) -> bool:
    try:
        agent.check_goal(episode.goal)
    except GoalError:
        return False
    return True


def _searched(
    built, world: SimulatedWorld, episode: Episode, memory: Memory | None
) -> tuple[EpisodeResult, float]:
    """The result of a search, and the processor time of a step, milliseconds."""
    began = time.process_time()
    run = EpisodeRun(
        built.agent, world, episode, rng=np.random.default_rng(0), told=built.truth, memory=memory
    )
    for _ in run:
        pass
    result = run.result()
    return result, 1000.0 * (time.process_time() - began) / max(result.steps, 1)


def _say(name: str, rows: list[tuple[int, float, float, bool, bool]]) -> None:
    _, spl, fresh, success, fresh_success = np.array(rows, dtype=float).mean(axis=0)
    print(
        f"{name}: SPL {spl:.3f} with memory, {fresh:.3f} without ({spl / fresh:.2f} times); "
        f"SR {success:.2f} and {fresh_success:.2f}; {len(rows)} searches"
    )


if __name__ == "__main__":
    tyro.cli(main)
