"""Compare how soon variants of an agent see things, a whole building with every search.

Run: python benchmarks/exploring.py --scenes houses:200000 houses:200001 \
    --variants "frontier=--agent frontier" "tour=" "greedy=--set geometric.order=greedy"

Where the robot goes before it sees its goal does not depend on the goal if nobody tells what it is.
So one search that never finds anything serves for all goals of a building: it notes where each
labelled kind of thing was in the image for the first time. The SPL of a goal is estimated as that
of a robot that goes on from there on the shortest path. Goals that are seen in the turn at the
start are left out, since no variant could do anything about them. Images have 320×240 pixels.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import tyro
from rich.console import Console
from rich.table import Table

from hypernav.app.build.agents import build_search
from hypernav.app.build.data.scenes import load_scene
from hypernav.app.build.presets import HyPerNavConfig, preset
from hypernav.core.episode import Episode
from hypernav.core.geometry.boxes import Detection
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import ExchangeLog
from hypernav.io.layered_config import layered
from hypernav.lab.episodes.goal_sight import MIN_VISIBLE_SHARE
from hypernav.search.agents.search import SearchAgent
from hypernav.search.memory.memory import Memory
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer, RenderConfig
from hypernav.simulator.worlds.simulation import SimulatedWorld

SMALL_IMAGES = ("embodiment.camera.width=320", "embodiment.camera.height=240")
NOTHING = Goal("nothing of the kind")


class Onlooker:
    """A detector that finds nothing and notes in which image each instance came into view."""

    gives_masks = True
    looks_at_colours = False

    def __init__(self) -> None:
        """Begin with nothing seen."""
        self.first_seen: dict[int, int] = {}
        self._images = 0

    def detect(self, observation: Observation, goal: Goal) -> list[Detection]:
        """Nothing."""
        del goal
        assert observation.truth is not None
        ids = observation.truth.ids
        pixels = np.bincount(ids.ravel() + 1)[1:]
        for instance in np.flatnonzero(pixels >= MIN_VISIBLE_SHARE * ids.size):
            self.first_seen.setdefault(int(instance), self._images)
        self._images += 1
        return []


@dataclass(frozen=True)
class Sight:
    """The first sight of a goal: number of the image, path until then, SPL; or that it had none."""

    image: float
    explored_m: float
    spl: float


@dataclass(frozen=True)
class Variant:
    """An agent with its configuration."""

    name: str
    agent: str
    config: HyPerNavConfig

    @staticmethod
    def read(text: str) -> "Variant":
        """A variant from ``NAME=[--agent AGENT] [--set SECTION.KEY=VALUE …]``."""
        name, _, options = text.partition("=")
        words = options.replace("--set", "").split()
        agent = "hypernav"
        if "--agent" in words:
            at = words.index("--agent")
            agent = words[at + 1]
            del words[at : at + 2]
        return Variant(name, agent, layered(preset("default"), assignments=[*SMALL_IMAGES, *words]))

    def search(self, onlooker: Onlooker) -> SearchAgent:
        """The agent, with an onlooker for a detector."""
        return build_search(self.config, onlooker, ExchangeLog(), agent=self.agent)


def first_sights(
    world: SimulatedWorld,
    agent: SearchAgent,
    onlooker: Onlooker,
    start: Pose2,
    memory: Memory | None = None,
) -> dict[str, Sight]:
    """When each goal of a building is first seen by a robot that looks for none of them.

    Args:
        world: The building.
        agent: Agent whose detector is the onlooker.
        onlooker: Onlooker that has seen nothing yet.
        start: Pose to begin at.
        memory: What the robot knows of the building; None if nothing.
    """
    episode = Episode("", "", NOTHING, start)
    observation = world.reset(episode)
    agent.reset(NOTHING, memory)
    goals = {goal: world.regions.of(Goal(goal)) for goal in world.regions.categories()}
    unseen = {goal: {one.id for one in region.instances} for goal, region in goals.items()}
    lengths, positions = list[float](), list[tuple[float, float, float]]()
    while len(lengths) < episode.max_steps and unseen:
        lengths.append(world.path_length_m)
        positions.append(world.position)
        action = agent.act(observation)
        if action is None:
            break
        observation = world.step(action)
        unseen = {g: ids for g, ids in unseen.items() if ids.isdisjoint(onlooker.first_seen)}
    sights = {}
    for goal, region in goals.items():
        seen = [onlooker.first_seen.get(one.id, math.inf) for one in region.instances]
        shortest, image = region.distance(*start.xy), min(seen, default=math.inf)
        if not math.isfinite(shortest):
            continue
        sights[goal] = Sight(image, math.nan, 0.0)
        if math.isfinite(image):
            explored = lengths[int(image)]
            path = explored + region.distance(*positions[int(image)][:2])
            spl = 1.0 if path <= shortest else shortest / path
            sights[goal] = Sight(image, explored, spl)
    return sights


def main(scenes: Sequence[str], variants: Sequence[str], starts: int = 2, seed: int = 7) -> None:
    """Compare variants.

    Args:
        scenes: Scenes, as `hypernav find --scene` knows them.
        variants: Variants, ``NAME=OPTIONS``; others are compared with the first.
        starts: Number of starts per scene.
        seed: Seed of the starts.
    """
    read = [Variant.read(text) for text in variants]
    console = Console()
    spls: dict[str, list[float]] = {one.name: [] for one in read}
    explored: dict[str, list[float]] = {one.name: [] for one in read}
    unseen = dict.fromkeys(spls, 0)
    goals = 0
    for name in scenes:
        scene = load_scene(name)
        drawing = RenderConfig(colours=False, antialias=False, threads=1)
        renderer = CpuRenderer(scene, drawing)
        world = SimulatedWorld(scene, None, read[0].config.embodiment, renderer=renderer)
        rng = np.random.default_rng(seed)
        for _ in range(starts):
            start = Pose2(*world.walkable.random_point(rng), rng.uniform(-math.pi, math.pi))
            found = {
                one.name: first_sights(world, one.search(seen := Onlooker()), seen, start)
                for one in read
            }
            turn = read[0].config.embodiment.motion.turns_of_a_circle
            some = [
                g for g in found[read[0].name] if all(f[g].image >= turn for f in found.values())
            ]
            if not some:
                continue
            goals += len(some)
            for one, sights in found.items():
                spls[one].append(float(np.mean([sights[goal].spl for goal in some])))
                explored[one] += [sights[goal].explored_m for goal in some]
                unseen[one] += sum(math.isinf(sights[goal].image) for goal in some)
        renderer.close()
        console.print(name, {one: round(float(np.mean(spl)), 3) for one, spl in spls.items()})
    table = Table(
        "variant", "SPL", "over the first", "± 95 %", "never seen", "metres to first sight"
    )
    first = np.array(spls[read[0].name])
    for one, values in spls.items():
        over = np.array(values) - first
        spread = 1.96 * over.std(ddof=1) / math.sqrt(len(over)) if len(over) > 1 else math.nan
        table.add_row(
            one,
            f"{np.mean(values):.3f}",
            f"{over.mean():+.3f}",
            f"{spread:.3f}",
            f"{unseen[one] / goals:.1%}",
            f"{np.nanmean(explored[one]):.1f}",
        )
    console.print(f"{len(first)} starts, {goals} goals", table)


if __name__ == "__main__":
    tyro.cli(main)
