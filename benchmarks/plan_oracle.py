"""Say how near exploration comes to that of a robot that knows the plan, but not where the goal is.

Run: python benchmarks/plan_oracle.py --scenes houses:200000 houses:200001 --starts 2

The oracle has the finished map of a search of the same building that found nothing, and drives on
it. Of the goal it knows nothing: it may be anywhere on the floor that no image has shown yet. The
oracle goes to the first of twelve positions, chosen one by one from all that it can reach, in the
order of the shortest mean path until a thing is seen that may be anywhere there, and thinks again
every third step. Walls, and what else is as high as the camera, end its view. A better order is not
proven impossible, so its metres are those of a very good explorer, not the optimum.

What counts is that of `benchmarks/exploring.py`: the path until each kind of thing is in the image
for the first time, without those that the first turn shows.
"""

import math
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass, field, replace

import numpy as np
import tyro
from exploring import NOTHING, Onlooker, Sight, Variant, first_sights
from jaxtyping import Bool, Float64, Int64
from rich.console import Console
from rich.table import Table

from hypernav.app.build.data.scenes import load_scene
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.episode import Episode
from hypernav.core.exploring.exploration import Destination, ExplorationView
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.agents.search import SearchAgent
from hypernav.search.mapping.grid_kernels import unknown_in_view
from hypernav.search.mapping.reachable_area import ReachableArea
from hypernav.search.mapping.sight_lines import find_legs_m
from hypernav.search.mapping.top_down_map import TopDownMap
from hypernav.search.memory.memory import Memory
from hypernav.search.perception.explorers.tour_kernels import soonest_tour, unseen_after
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer, RenderConfig
from hypernav.simulator.worlds.simulation import SimulatedWorld

SPACING_M = 0.5
"""Distance between the positions that the oracle thinks of."""
STOPS = 12
SCALE_M = 3.0
"""Length of path over which floor counts 1/e, while the stops are chosen."""
ASK_STEPS = 3
LEAST_M2 = 1.0
"""Area of unseen floor below which nothing is left to look at."""
RAYS, PATCH_CELLS = 180, 4
MOST_STEPS = 2000
"""Steps in which the map is finished."""

Mask = Bool[np.ndarray, "rows columns"]


@dataclass(eq=False)
class Notes:
    """What the oracle has seen.

    Attributes:
        seen: Map of what the images of this search have shown.
        aimed_at: Positions ``(x, y)`` that the last image at the present stop is to show, metres.
        looked_at: Positions that the robot turned to; what it still did not see there can't be seen
            from anywhere near.
        visits: Number of visits that are in `looked_at`.
    """

    seen: TopDownMap
    aimed_at: Float64[np.ndarray, "n 2"] = field(default_factory=lambda: np.empty((0, 2)))
    looked_at: Float64[np.ndarray, "m 2"] = field(default_factory=lambda: np.empty((0, 2)))
    visits: int = 0


class PlanExplorer:
    """Goes where the floor that no image has shown comes into view soonest."""

    def __init__(self, plan: TopDownMap, config: HyPerNavConfig) -> None:
        """Take the finished map."""
        self._config = config
        ends = np.array([[0, 0], plan.grid.cells.shape]) - [[0, 0], [1, 1]]
        self._walls = plan.eye_level(plan.grid.centres_of(ends))

    def learn(self, view: ExplorationView) -> None:
        """Note what an image shows."""
        self._notes(view).seen.integrate(view.observation)

    def _notes(self, view: ExplorationView) -> Notes:
        if "plan" not in view.notes:
            view.notes["plan"] = Notes(TopDownMap(self._config.mapping, self._config.embodiment))
        return view.notes["plan"]

    def next_destination(self, view: ExplorationView) -> Destination | None:
        """The first stop of the tour; None once all has been seen that can be."""
        notes = self._notes(view)
        if len(view.visits) > notes.visits:
            notes.looked_at = np.concatenate([notes.looked_at, notes.aimed_at])
            notes.visits = len(view.visits)
        clearance_m = self._config.planning.clearances_m(self._config.embodiment.body)[0]
        reach = ReachableArea.of(view.grid, view.robot, self._config.mapping, clearance_m)
        at = lattice(reach)
        areas_m2, shows, middles = self._views(reach, at, notes)
        costs = reach.travel_m[tuple(at.T)].astype(np.float64)
        stops = best_views(areas_m2, shows, costs)
        if not stops:
            return None
        positions = [reach.grid.centre_of(*cell) for cell in at[stops].tolist()]
        unseen = unseen_after(areas_m2, shows[stops]) + LEAST_M2
        first = soonest_tour(costs[stops], find_legs_m(reach, positions), unseen)[0]
        shown = shows[stops[first]]
        face, in_image = self._widest(middles[shown] - np.array(positions[first]), areas_m2[shown])
        notes.aimed_at = middles[shown][in_image]
        x, y = positions[first]
        return Destination(x, y, "by the plan", holds=True, face=face, most_steps=ASK_STEPS)

    def _widest(
        self, offsets: Float64[np.ndarray, "n 2"], areas_m2: Float64[np.ndarray, "n"]
    ) -> tuple[float, Bool[np.ndarray, "n"]]:
        """Heading in which an image shows the most, and what it shows."""
        half = math.radians(self._config.embodiment.camera.hfov_deg / 2.0 - 5.0)
        bearings = np.arctan2(offsets[:, 1], offsets[:, 0])
        headings = np.linspace(-math.pi, math.pi, 24, endpoint=False)
        away = np.abs((bearings - headings[:, None] + math.pi) % math.tau - math.pi)
        best = int(((away <= half) @ areas_m2).argmax())
        return float(headings[best]), away[best] <= half

    def _views(
        self, reach: ReachableArea, at: Int64[np.ndarray, "n 2"], notes: Notes
    ) -> tuple[
        Float64[np.ndarray, "areas"], Bool[np.ndarray, "n areas"], Float64[np.ndarray, "areas 2"]
    ]:
        """Patches of floor that no image has shown, which of them a position shows, and middles."""
        size = reach.grid.resolution_m
        range_cells = math.ceil(self._config.embodiment.camera.max_depth_m / size)
        # The kernel finds the unknown that rays go through: here the floor that was not seen.
        cells = np.full(reach.grid.cells.shape, Cell.FREE, dtype=np.uint8)
        cells[reach.grid.free & ~moved(notes.seen.grid, "explored", reach.grid)] = Cell.UNKNOWN
        cells[moved(self._walls, "occupied", reach.grid)] = Cell.OCCUPIED
        for row, column in reach.grid.cells_of(notes.looked_at):
            around = cells[max(row - 2, 0) : row + 2, max(column - 2, 0) : column + 2]
            around[around == Cell.UNKNOWN] = Cell.FREE
        cells = np.pad(cells, range_cells, constant_values=Cell.OCCUPIED)
        shows, chance = unknown_in_view(
            cells, at + range_cells, range_cells, RAYS, math.inf, PATCH_CELLS
        )
        sizes = (cells == Cell.UNKNOWN).astype(np.int64)
        for axis in (0, 1):
            edges = np.arange(0, sizes.shape[axis], PATCH_CELLS)
            sizes = np.add.reduceat(sizes, edges, axis=axis)
        in_view = chance > 0.0
        corner = np.array(reach.grid.origin) - range_cells * size
        middles = corner + (np.argwhere(in_view)[:, ::-1] + 0.5) * PATCH_CELLS * size
        return sizes[in_view] * size**2, shows[:, in_view], middles


def lattice(reach: ReachableArea) -> Int64[np.ndarray, "n 2"]:
    """Reachable cells a little apart, ``[row, column]``."""
    step = round(SPACING_M / reach.grid.resolution_m)
    cells = np.argwhere(reach.reachable[::step, ::step])
    return cells * step


def best_views(
    areas_m2: Float64[np.ndarray, "areas"],
    shows: Bool[np.ndarray, "n areas"],
    costs: Float64[np.ndarray, "n"],
) -> list[int]:
    """Positions that show the most for their distance, besides what those chosen before show."""
    left, chosen = areas_m2.copy(), list[int]()
    while len(costs) > 0 and len(chosen) < STOPS:
        gains = shows @ left
        best = int(np.argmax(np.where(gains < LEAST_M2, 0.0, gains * np.exp(-costs / SCALE_M))))
        if gains[best] < LEAST_M2:
            break
        chosen.append(best)
        left[shows[best]] = 0.0
    return chosen


def moved(source: OccupancyGrid, states: str, to: OccupancyGrid) -> Mask:
    """A mask of one grid in the cells of another."""
    cells = to.cells_of(source.centres_of(np.argwhere(getattr(source, states))))
    mask = np.zeros(to.cells.shape, dtype=bool)
    mask[tuple(cells[to.contains(cells)].T)] = True
    return mask


def finished_map(world: SimulatedWorld, variant: Variant, start: Pose2) -> TopDownMap:
    """The map when a search for something that is not there has ended."""
    agent = variant.search(Onlooker())
    agent.reset(NOTHING)
    observation = world.reset(Episode("", "", NOTHING, start))
    for _ in range(MOST_STEPS):
        action = agent.act(observation)
        if action is None:
            break
        observation = world.step(action)
    return agent.memory.floor.map


def sights_by_plan(
    world: SimulatedWorld, variant: Variant, start: Pose2, plan: TopDownMap
) -> dict[str, Sight]:
    """When each goal is first seen by a robot that has the plan."""
    parts = variant.search(seen := Onlooker()).components
    explorer = PlanExplorer(plan, variant.config)
    memory = Memory(parts.mapping, parts.embodiment)
    memory.floor.map = plan
    return first_sights(world, SearchAgent(replace(parts, explorer=explorer)), seen, start, memory)


def main(scenes: Sequence[str], starts: int = 2, seed: int = 7) -> None:
    """Compare the paths until goals are seen.

    Args:
        scenes: Scenes, as `hypernav find --scene` knows them.
        starts: Number of starts per scene.
        seed: Seed of the starts.
    """
    variants = [Variant.read("hypernav="), Variant.read("frontier=--agent frontier")]
    metres: dict[str, list[float]] = {name: [] for name in ("plan", *(v.name for v in variants))}
    spls: dict[str, list[float]] = {name: [] for name in metres}
    config = variants[0].config
    console = Console()
    for name in scenes:
        scene = load_scene(name)
        drawing = RenderConfig(colours=False, antialias=False, threads=1)
        with closing(CpuRenderer(scene, drawing)) as renderer:
            world = SimulatedWorld(scene, None, config.embodiment, renderer=renderer)
            rng = np.random.default_rng(seed)
            for _ in range(starts):
                start = Pose2(*world.walkable.random_point(rng), rng.uniform(-math.pi, math.pi))
                plan = finished_map(world, variants[0], start)
                found = {"plan": sights_by_plan(world, variants[0], start, plan)}
                for one in variants:
                    agent = one.search(seen := Onlooker())
                    found[one.name] = first_sights(world, agent, seen, start)
                turn = config.embodiment.motion.turns_of_a_circle
                for goal in found["plan"]:
                    images = [sights[goal].image for sights in found.values()]
                    if all(turn <= image < math.inf for image in images):
                        for one, sights in found.items():
                            metres[one].append(sights[goal].explored_m)
                            spls[one].append(sights[goal].spl)
        console.print(name, {one: round(float(np.mean(all_)), 2) for one, all_ in metres.items()})
    table = Table("explorer", "metres to first sight", "over the plan's", "SPL")
    for one in metres:
        mean_m = float(np.mean(metres[one]))
        over = mean_m / float(np.mean(metres["plan"]))
        table.add_row(one, f"{mean_m:.1f}", f"{over:.2f}", f"{np.mean(spls[one]):.3f}")
    console.print(f"{len(metres['plan'])} goals that all of them see", table)


if __name__ == "__main__":
    tyro.cli(main)
