"""How often a robot that begins where its memory says is refused, and how often one elsewhere is.

Run: python benchmarks/start_check.py --houses 3006 3010
     python benchmarks/start_check.py --houses 3006 3008 --camera 1280 720 --noise

In each building a few goals are searched with true labels. Then robots stand at random starts, in
the building as it was and with a share of its things moved, and look once around. Every start is
checked three times with a wrong pose, too: turned by 30 degrees or more, moved by 1 to 3 m, and as
if it were in the building before. What the first image shows, and what all do, count together.
"""

import math
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import tyro
from moved_things import with_moved_things

from hypernav.app.build.agents import build_agent
from hypernav.app.build.data.datasets import load_episodes
from hypernav.app.build.data.scenes import load_scene
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.embodiment import Action
from hypernav.core.episode import Episode
from hypernav.core.errors import MemoryStartError
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.observation import Observation
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.search.memory.memory import Memory
from hypernav.search.memory.start.start_check import StartCheck
from hypernav.simulator.worlds.simulation import SimulatedWorld
from hypernav.simulator.worlds.surface.goal_regions import random_start

_NOISE = {"depth_sigma_m": 0.004, "depth_edge_px": 1, "forward_sigma": 0.02, "turn_sigma_deg": 1.0}


def main(
    houses: tuple[int, int] = (3006, 3010),
    kind: str = "houses",
    camera: tuple[int, int] = (160, 120),
    lens_height_m: float = 0.88,
    noise: bool = False,
    goals: int = 2,
    starts: int = 10,
    moved: float = 0.3,
) -> None:
    """Print how many right starts are accepted, and how many wrong ones are noticed.

    Args:
        houses: First building of the training split, and the one after the last.
        kind: Kind of building: houses or offices.
        camera: Width and height of the image, pixels.
        lens_height_m: Height of the camera, and 0.12 m less than that of the body, metres.
        noise: Whether depth and motion have the noise of a cheap camera and robot.
        goals: Number of goals that are searched before.
        starts: Number of starts in each building, with and without moved things.
        moved: Share of the things that are moved.
    """
    body = {"camera": {"width": camera[0], "height": camera[1], "height_m": lens_height_m}}
    body |= {"body": {"height_m": lens_height_m + 0.12}}
    changes = {"embodiment": body, "world": {"noise": _NOISE if noise else {}}}
    config = HyPerNavConfig().with_(**changes)
    told, before = Counter[tuple[str, bool]](), list[list[Observation]]()
    for number in range(*houses):
        rng, name = np.random.default_rng(number), f"{kind}:{number}"
        scene = load_scene(name)
        episodes = load_episodes(f"{kind}-train#{number}:{number + 1}")
        life = list({one.goal.text: one for one in reversed(episodes)}.values())[:goals]
        world = SimulatedWorld(scene, config.world, config.embodiment)
        memory = _lived(world, life, config)
        map_to_scene, here = world.map_to_scene, list[list[Observation]]()
        for share in (0.0, moved):
            if share > 0.0:
                at = (life[0].start.x, life[0].start.y)
                other, _ = with_moved_things(scene, world.walkable, share, at, rng)
                world = SimulatedWorld(other, config.world, config.embodiment)
            for _ in range(starts):
                start = random_start(world.walkable, rng)
                frames = _turn(world, Episode(name, "", life[0].goal, start), rng)
                own_to_map = map_to_scene.inverse() @ world.map_to_scene
                here.append([one.in_frame(own_to_map) for one in frames])
        for k, frames in enumerate(here):
            told["right", _is_refused(memory, frames)] += 1
            for case, wrong in _wrong(frames, before[k % len(before)] if before else None, rng):
                told[case, _is_refused(memory, wrong)] += 1
        before = here
        print(number, dict(told), flush=True)
    for case in dict.fromkeys(case for case, _ in told):
        refused, accepted = told[case, True], told[case, False]
        print(f"{case}: {refused} refused, {accepted} accepted")


def _lived(world: SimulatedWorld, life: list[Episode], config: HyPerNavConfig) -> Memory:
    """What is known after a life."""
    built, memory = build_agent(config), Memory(config.mapping, config.embodiment)
    for k, episode in enumerate(life):
        rng = np.random.default_rng(0)
        run = EpisodeRun(
            built.agent, world, episode, rng=rng, told=built.truth, goes_on=k > 0, memory=memory
        )
        for _ in run:
            pass
    return memory


def _turn(world: SimulatedWorld, episode: Episode, rng: np.random.Generator) -> list[Observation]:
    first = world.reset(episode, rng)
    turns = world.embodiment.motion.turns_of_a_circle - 1
    return [first, *(world.step(Action.TURN_LEFT) for _ in range(turns))]


def _wrong(
    frames: list[Observation], elsewhere: list[Observation] | None, rng: np.random.Generator
) -> Iterator[tuple[str, list[Observation]]]:
    """The same frames with wrong poses, and those of another building with these poses."""
    said = frames[0].robot
    yaw = math.radians(rng.uniform(30.0, 330.0))
    yield "turned", _posed(frames, Pose2(said.x, said.y, said.yaw + yaw))
    far, way = rng.uniform(1.0, 3.0), rng.uniform(0.0, math.tau)
    x, y = said.x + far * math.cos(way), said.y + far * math.sin(way)
    yield "moved", _posed(frames, Pose2(x, y, said.yaw))
    if elsewhere is not None:
        yield "another building", _posed(elsewhere, said)


def _posed(frames: list[Observation], first: Pose2) -> list[Observation]:
    """Frames as if the first were from a pose."""
    shift: Transform = first.to_transform() @ frames[0].robot.to_transform().inverse()
    return [one.in_frame(shift) for one in frames]


def _is_refused(memory: Memory, frames: list[Observation]) -> bool:
    try:
        check = StartCheck(memory, frames[0], Path("memory"), trusts_height=True)
        for frame in frames[1:]:
            check.look(frame)
    except MemoryStartError:
        return True
    return False


if __name__ == "__main__":
    tyro.cli(main)
