"""Say how much sooner a goal is seen by a robot that knows in which rooms it can be.

Run: python benchmarks/room_oracle.py --data 'houses-train#210000:210006' --every 3

This is an upper bound for every rule that tells rooms by what was seen in them. The unknown floor
that a block would show counts in full where the robot thinks that the goal can be, and little
elsewhere; all else is `hypernav` as it is. What it is told:

- nothing: geometry alone.
- kinds seen: the true kind of every room that an image has shown something of, and in which kinds
  of rooms of this building the goal stands. All other rooms count as the building's average does:
  no table of what stands where can know more of them.
- kinds seen, doors: the same, and which of the other rooms lie open on one side and which only
  have doors; they count as the average of these does.
- kinds: the same of all rooms, seen or not.
- rooms: the very rooms that the goal stands in.

A search ends where the goal is first in the image; SPL is that of a robot that goes on from there
on the shortest path. Images have 320×240 pixels. Generated buildings only, whose plans tell rooms.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np
import tyro
from jaxtyping import Float64, Int64
from rich.console import Console
from rich.table import Table

from hypernav.app.build.agents import build_search
from hypernav.app.build.data.scenes import load_scene
from hypernav.app.build.data.sources import DATA_SOURCES, DatasetRequest
from hypernav.app.build.presets import preset
from hypernav.core.episode import Episode
from hypernav.core.exploring.overview import Block, BlockChoice, Prospects
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog
from hypernav.io.layered_config import layered
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.search.perception.explorers.block_explorer import MapOverview
from hypernav.search.perception.explorers.geometric_reasoner import GeometricReasoner
from hypernav.search.perception.local.stand_ins.ground_truth import (
    GroundTruthDetector,
    visible_objects,
)
from hypernav.simulator.houses.generator import plan_of
from hypernav.simulator.houses.named_scenes import building_of
from hypernav.simulator.houses.plan.floor_plan import FloorPlan
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer, RenderConfig
from hypernav.simulator.worlds.simulation import SimulatedWorld

SMALL_IMAGES = ("embodiment.camera.width=320", "embodiment.camera.height=240")
KNOWLEDGE = ("nothing", "kinds seen", "kinds seen, doors", "kinds", "rooms")

Weigh = Callable[[Float64[np.ndarray, "n 2"]], Float64[np.ndarray, "n"]]
"""Function that tells the weights of positions ``(x, y)``, ``map`` frame, metres."""


@dataclass(frozen=True, eq=False, kw_only=True)
class _Weighed(MapOverview):
    """Blocks of which some show floor that counts less."""

    weigh: Weigh

    def prospects(self, blocks: Sequence[Block]) -> Prospects:
        """What visits to some blocks would show."""
        found = super().prospects(blocks)
        return replace(found, areas_m2=found.areas_m2 * self.weigh(found.positions))


class WeighingReasoner:
    """The geometric reasoner over unknown floor of which some counts less."""

    answers_at_once = True

    def __init__(self, log: ExchangeLog) -> None:
        """Begin with floor that counts alike."""
        self._geometric = GeometricReasoner(log)
        self.weigh: Weigh = lambda positions: np.ones(len(positions))

    def choose(self, overview: MapOverview, goal: Goal, excluded: frozenset[int]) -> BlockChoice:
        """The choice of the geometric reasoner."""
        weighed = _Weighed(**vars(overview), weigh=self.weigh)
        return self._geometric.choose(weighed, goal, excluded)


class RoomOracle:
    """Weighs floor by the truth about the rooms of a building.

    Attributes:
        seen: Numbers of the rooms that an image has shown something of.
    """

    def __init__(
        self, knowledge: str, plan: FloorPlan, world: SimulatedWorld, goal: Goal, elsewhere: float
    ) -> None:
        """Look up where the goal is."""
        self._knowledge, self._plan, self._world = knowledge, plan, world
        middles = [
            ((one.box_min[0] + one.box_max[0]) / 2.0, (one.box_min[1] + one.box_max[1]) / 2.0)
            for one in world.regions.of(goal).instances
        ]
        self._elsewhere = elsewhere
        self._rooms = set(self.rooms_at(np.array(middles)).tolist()) - {-1}
        self._kinds = {plan.rooms[room].kind for room in self._rooms}
        self.seen: set[int] = set()

    def rooms_at(self, positions: Float64[np.ndarray, "n 2"]) -> Int64[np.ndarray, "n"]:
        """Numbers of the rooms at positions, scene frame; -1 for outside."""
        found = np.full(len(positions), -1)
        x, y = positions.T
        for number, room in enumerate(self._plan.rooms):
            cell = room.cell
            found[(x >= cell.x0) & (x < cell.x1) & (y >= cell.y0) & (y < cell.y1)] = number
        return found

    def __call__(self, positions: Float64[np.ndarray, "n 2"]) -> Float64[np.ndarray, "n"]:
        """Weights of positions, ``map`` frame."""
        if self._knowledge == "nothing":
            return np.ones(len(positions))
        lifted = np.column_stack([positions, np.zeros(len(positions))])
        rooms = self.rooms_at(self._world.map_to_scene.apply(lifted)[:, :2])
        return np.append([self._weight(k) for k in range(len(self._plan.rooms))], self._outside)[
            rooms
        ]

    @property
    def _outside(self) -> float:
        """Weight of what lies in no room, which nobody tells from a room that was not seen."""
        if self._knowledge in ("kinds", "rooms"):
            return self._elsewhere
        return self._average(range(len(self._plan.rooms)))

    def _average(self, rooms: Sequence[int]) -> float:
        """Mean weight of the floor of some rooms, by their kinds."""
        kinds = [self._plan.rooms[k].kind for k in rooms]
        areas = [self._plan.rooms[k].cell.area for k in rooms]
        weights = [1.0 if kind in self._kinds else self._elsewhere for kind in kinds]
        return float(np.average(weights, weights=areas))

    def _is_open(self, room: int) -> bool:
        return any(opening.kind == "passage" for opening in self._plan.openings_of(room))

    def _weight(self, number: int) -> float:
        everywhere = range(len(self._plan.rooms))
        if self._knowledge == "rooms":
            return 1.0 if number in self._rooms else self._elsewhere
        if self._knowledge == "kinds" or number in self.seen:
            return self._average([number])
        if self._knowledge == "kinds seen":
            return self._average(everywhere)
        alike = [k for k in everywhere if self._is_open(k) == self._is_open(number)]
        return self._average(alike)


def first_sight_spl(
    run: EpisodeRun, oracle: RoomOracle, rooms_of: dict[int, int]
) -> tuple[float, float]:
    """SPL of a robot that goes straight to the goal from its first sight, and metres until then."""
    for step in run:
        if step.goal_in_view:
            break
        assert step.observation.truth is not None
        shown = visible_objects(step.observation.truth)
        oracle.seen |= {rooms_of[number] for number in shown} - {-1}
    result = run.result()
    if result.parts is None:
        return 0.0, result.metrics.path_length_m
    shortest_m = result.metrics.shortest_path_m
    path_m = result.parts.explored_m + result.parts.shortest_from_sight_m
    return shortest_m / max(path_m, shortest_m), result.parts.explored_m


def main(data: Sequence[str], every: int = 1, elsewhere: float = 0.05) -> None:
    """Compare what a robot may know of the rooms.

    Args:
        data: Episodes, as `hypernav eval` knows them.
        every: Only every n-th episode of each is run.
        elsewhere: Weight of floor where the goal can't be.
    """
    config = layered(preset("default"), assignments=SMALL_IMAGES)
    reasoner = WeighingReasoner(log := ExchangeLog())
    agent = build_search(config, GroundTruthDetector(), log, reasoner=reasoner)
    spl: dict[str, list[float]] = {name: [] for name in KNOWLEDGE}
    metres: dict[str, list[float]] = {name: [] for name in KNOWLEDGE}
    episodes: list[Episode] = []
    for name in data:
        choice = DATA_SOURCES.find(name.partition("#")[0])
        request = DatasetRequest(part=name.partition("#")[2])
        found = sorted(choice.load()(request), key=lambda one: one.scene_id)
        episodes += found[::every]
    console = Console()
    for scene_id, group in groupby(episodes, lambda one: one.scene_id):
        scene, plan = load_scene(scene_id), plan_of(building_of(scene_id))
        renderer = CpuRenderer(scene, RenderConfig(colours=False, threads=1))
        world = SimulatedWorld(scene, config.world, config.embodiment, renderer=renderer)
        for episode in group:
            for name in KNOWLEDGE:
                rng = np.random.default_rng(episode.seed(0))
                run = EpisodeRun(agent, world, episode, rng=rng)
                oracle = RoomOracle(name, plan, world, episode.goal, elsewhere)
                boxes = np.array([(*one.box_min, *one.box_max) for one in world.instances])
                middles = (boxes[:, :2] + boxes[:, 3:5]) / 2.0
                rooms_of = dict(enumerate(oracle.rooms_at(middles).tolist()))
                reasoner.weigh = oracle
                value, explored_m = first_sight_spl(run, oracle, rooms_of)
                spl[name].append(value)
                metres[name].append(explored_m)
        world.close()
        console.print(scene_id, {one: round(float(np.mean(spl[one])), 3) for one in KNOWLEDGE})
    table = Table("told", "SPL", "over nothing", "± 95 %", "metres to first sight")
    for name in KNOWLEDGE:
        over = np.array(spl[name]) - np.array(spl["nothing"])
        spread = 1.96 * over.std(ddof=1) / np.sqrt(len(over))
        table.add_row(
            name,
            f"{np.mean(spl[name]):.3f}",
            f"{over.mean():+.3f}",
            f"{spread:.3f}",
            f"{np.mean(metres[name]):.1f}",
        )
    console.print(f"{len(episodes)} episodes", table)


if __name__ == "__main__":
    tyro.cli(main)
