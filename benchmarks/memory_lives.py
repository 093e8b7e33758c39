"""What a memory is worth: goals of one building in a row, with the memory and with a fresh one.

Run: python benchmarks/memory_lives.py --houses 3000 3004 --goals 6
     python benchmarks/memory_lives.py --detector yolox:yolox_nano.onnx
     python benchmarks/memory_lives.py --moved 0.1

Every goal starts where the search with memory for the one before ended, and both searches start
there. At the end the first goal is asked for once more, when much has been seen. With ``--moved``
that share of all things is moved between two goals, and the goals are such things.
"""

import itertools
import time
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import tyro
from moved_things import movable_names, with_moved_things

from hypernav.app.build.agents import build_agent
from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.data.datasets import load_episodes
from hypernav.app.build.data.scenes import load_scene
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.episode import Episode
from hypernav.core.errors import GoalError
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.lab.episodes.episode_run import EpisodeResult, EpisodeRun
from hypernav.lab.evaluation.statistics import drawn, ratio_with_interval
from hypernav.search.memory.memory import Memory
from hypernav.simulator.worlds.simulation import SimulatedWorld

_LEAST_M = 3.0


class _Row(NamedTuple):
    """A goal of a life, with the memory kept and with a fresh one."""

    house: str
    number: int
    spl: float
    fresh_spl: float
    success: bool
    fresh_success: bool
    was_moved: bool


def main(
    houses: tuple[int, int] = (3000, 3004),
    goals: int = 6,
    detector: str | None = None,
    moved: float = 0.0,
) -> None:
    """Print SPL and steps with and without memory.

    Args:
        houses: First building of houses-train, and the one after the last.
        goals: Number of goals of a life.
        detector: Detector; true labels unless given.
        moved: Share of the things that are moved before every goal but the first, which is a large
            thing; the others are things that may have been moved, at least 3 m away.
    """
    config, specs = HyPerNavConfig(), ComponentSpecs(detector=detector)
    remembering, fresh = build_agent(config, specs), build_agent(config, specs)
    rows = list[_Row]()
    for number in range(*houses):
        episodes = load_episodes(f"houses-train#{number}:{number + 1}")
        wanted = {one.goal.text: one for one in reversed(episodes)}
        life = list(
            itertools.islice(filter(lambda one: _can_find(fresh, one), wanted.values()), goals)
        )
        scene, rng = load_scene(f"houses:{number}"), np.random.default_rng(number)
        memory, frame, start = Memory(config.mapping, config.embodiment), None, life[0].start
        elsewhere = set[int]()
        world = SimulatedWorld(scene, config.world, config.embodiment)
        names = rng.permutation(movable_names(scene)).tolist() if moved else []
        for k, episode in enumerate([*life, life[0]]):
            if k and moved:
                world.close()
                scene, now = with_moved_things(scene, world.walkable, moved, start.xy, rng)
                world = SimulatedWorld(scene, config.world, config.embodiment)
                elsewhere |= now
                name = next(one for one in names if _distance_m(world, one, start) >= _LEAST_M)
                names.remove(name)
                episode = replace(episode, goal=Goal(name), objects=())
            episode = replace(episode, start=start, view_points=None)
            goals_of_it = {one.id for one in world.goal_truth(episode.goal).instances}
            was_moved = not elsewhere.isdisjoint(goals_of_it)
            world.keep_map_frame(frame)
            with_memory, ms = _searched(remembering, world, episode, memory)
            frame, start = world.map_to_scene, world.pose
            world.keep_map_frame(None)
            without, fresh_ms = _searched(fresh, world, episode, None)
            a, b = with_memory.metrics, without.metrics
            rows.append(_Row(str(number), k, a.spl, b.spl, a.success, b.success, was_moved))
            print(
                f"{number} {k} {episode.goal.text:16} SPL {a.spl:.2f} in {with_memory.steps} "
                f"steps of {ms:.0f} ms, fresh {b.spl:.2f} in {without.steps} of {fresh_ms:.0f}"
                f"{', moved' if was_moved else ''}",
                flush=True,
            )
        world.close()
    _say("goals 2 and later", [one for one in rows if one.number > 0])
    if not moved:
        _say("the first goal again", [one for one in rows if one.number == goals])
    elif any(one.was_moved for one in rows):
        _say("those of which one was moved", [one for one in rows if one.was_moved])


def _distance_m(world: SimulatedWorld, name: str, start: Pose2) -> float:
    """Length of the path to a goal, metres; 0 if there is none."""
    metres = world.goal_truth(Goal(name)).distance(*start.xy, 0.0)
    return metres if np.isfinite(metres) else 0.0


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


def _say(name: str, rows: list[_Row]) -> None:
    kept, fresh = [one.spl for one in rows], [one.fresh_spl for one in rows]
    success = np.mean([(one.success, one.fresh_success) for one in rows], axis=0)
    houses = [one.house for one in rows]
    times = ratio_with_interval(kept, fresh, houses)
    print(
        f"{name}: SPL {np.mean(kept):.3f} with memory, {np.mean(fresh):.3f} without "
        f"({times.mean:.2f} times, {times.low:.2f} to {times.high:.2f} with 95 % over "
        f"{drawn(houses)}); SR {success[0]:.2f} and {success[1]:.2f}; {len(rows)} searches"
    )


if __name__ == "__main__":
    tyro.cli(main)
