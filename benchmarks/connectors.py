"""How well stairs are told from depth alone, against the true stairs of generated buildings.

python benchmarks/connectors.py 3000 3020 --out runs/connectors
python benchmarks/connectors.py 3000 3020 --falls --out runs/falls

A search that never finds anything walks through each building, on the robot that climbs. Each
building is a line of ``walks.jsonl``; the same command goes on where it was interrupted. With
``--falls`` a robot that can't climb begins at the head of every building's stairs, facing them.
Images have 320×240 pixels.
"""

import json
import math
import multiprocessing
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import closing
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import tyro
from exploring import NOTHING, SMALL_IMAGES, Onlooker

from hypernav.app.build.agents import build_search
from hypernav.app.build.presets import HyPerNavConfig, preset
from hypernav.app.show.climbs import Climb, climbs
from hypernav.core.embodiment import Action
from hypernav.core.episode import Episode
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.trace import ExchangeLog, StepTrace
from hypernav.io.layered_config import layered
from hypernav.search.mapping.stairs.connectors import Passage
from hypernav.simulator.houses.building import Building
from hypernav.simulator.houses.episodes.building_truth import CLIMBING_BODY
from hypernav.simulator.houses.generator import storeys_of
from hypernav.simulator.houses.house_cache import cached_building
from hypernav.simulator.houses.plan.floor_plan import FloorPlan, Rect, Stairwell
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer, RenderConfig
from hypernav.simulator.worlds.navmesh.navmesh_surface import NavmeshSurface
from hypernav.simulator.worlds.simulation import SimulatedWorld

_SAME_M, _SAME_Z_M = 1.0, 0.6
"""Distances of a connector from the true end of stairs that it stands for, metres."""
_NEAR_M = 3.0
_ON_FLOOR_M = 0.1
_FROM_HEAD_M = 0.8
_DOWN, _UP = "down", "up"

Point = tuple[float, float, float]


@dataclass(frozen=True)
class TrueEnd:
    """An end of true stairs: the foot of stairs up or the head of stairs down.

    Attributes:
        at: Middle of the first edge, scene frame, metres.
        goes: "up" or "down".
        axis: Direction in which the stairs lead away, radians.
    """

    at: Point
    goes: str
    axis: float

    def is_at(self, position: Point, *, reach_m: float = _SAME_M) -> bool:
        """Whether a position on this storey is within reach."""
        apart = math.dist(self.at[:2], position[:2])
        return apart <= reach_m and abs(self.at[2] - position[2]) <= _SAME_Z_M


def true_ends(plans: Sequence[FloorPlan]) -> list[TrueEnd]:
    """All ends of the stairs of a building."""
    ends = list[TrueEnd]()
    for below, above in pairwise(plans):
        stairs = below.stairwell
        assert stairs is not None
        foot = np.mean([stairs.foot.start, stairs.foot.end], axis=0)
        first = np.array(stairs.steps[0].rect.centre)
        head, away = _head(stairs)
        ends.append(TrueEnd((*foot, below.floor_z), _UP, math.atan2(*(first - foot)[::-1])))
        ends.append(TrueEnd((*head, above.floor_z), _DOWN, math.atan2(*away[::-1])))
    return ends


def _head(stairs: Stairwell) -> tuple[Any, Any]:
    """Middle of the edge above the last step, and the direction in which it leads down."""
    before, last = (np.array(one.rect.centre) for one in stairs.steps[-2:])
    rect = stairs.steps[-1].rect
    along = np.abs(last - before).argmax()
    ahead = np.zeros(2)
    ahead[along] = np.sign((last - before)[along])
    half = (rect.x1 - rect.x0, rect.y1 - rect.y0)[along] / 2.0
    return last + half * ahead, -ahead


def settings(*assignments: str) -> HyPerNavConfig:
    """The `default` preset with small images."""
    return layered(preset("default"), assignments=[*SMALL_IMAGES, *assignments])


@dataclass(frozen=True, eq=False)
class Walk:
    """A search in a building, after its last step.

    Attributes:
        traces: Its steps.
        positions: Where the robot was before each of them, scene frame.
        headings: Where it looked, scene frame, radians.
        connectors: What stood for stairs at any time: position in the scene frame and direction.
        refuted: Indices of those that were refuted.
    """

    traces: list[StepTrace]
    positions: list[Point]
    headings: list[float]
    connectors: list[tuple[Point, str]]
    refuted: set[int]


def walk(world: SimulatedWorld, config: HyPerNavConfig, start: Episode) -> Walk:
    """Search for nothing."""
    agent = build_search(config, Onlooker(), ExchangeLog())
    observation = world.reset(start)
    agent.reset(NOTHING)
    traces, positions, relied = list[StepTrace](), list[Point](), dict[int, Any]()
    while len(traces) < start.max_steps:
        positions.append(world.position)
        action = agent.act(observation)
        traces.append(agent.last_step)
        usable = enumerate(agent.memory.connectors)
        relied |= {number: one for number, one in usable if one.is_usable}
        if action is None:
            break
        observation = world.step(action)
    known, refuted = list[tuple[Point, str]](), set[int]()
    for number in relied:
        one = agent.memory.connectors[number]
        z = agent.memory.floors[one.floor].z
        x, y, z = world.map_to_scene.apply(np.array([[*one.end, z]]))[0]
        if one.passage is Passage.REFUTED:
            refuted.add(len(known))
        known.append(((float(x), float(y), float(z)), _UP if one.goes_up else _DOWN))
    headings = [start.start.yaw + one.pose[2] for one in traces]
    return Walk(traces, positions, headings, known, refuted)


def measures(done: Walk, ends: Sequence[TrueEnd]) -> dict[str, int]:
    """What a walk says of the stairs of a building, as counts."""
    counts = Counter[str](steps=len(done.traces))
    for number, (at, goes) in enumerate(done.connectors):
        is_true = any(end.goes == goes and end.is_at(at) for end in ends)
        counts[f"{goes} {'true' if is_true else 'false'}"] += 1
        counts[f"{goes} false at the end"] += not is_true and number not in done.refuted
    for end in ends:
        was_near = any(end.is_at(one, reach_m=_NEAR_M) for one in done.positions)
        found = any(end.goes == goes and end.is_at(at) for at, goes in done.connectors)
        counts[f"{end.goes} near"] += was_near
        counts[f"{end.goes} near and found"] += was_near and found
    for climb in climbs(done.traces):
        end = _begun_at(climb, done, ends)
        kind = "stray" if end is None else end.goes
        counts[f"{kind} tried"] += climb.other_floor is not None or climb.given_up
        counts[f"{kind} taken"] += climb.other_floor is not None
    return dict(counts)


def _begun_at(climb: Climb, done: Walk, ends: Sequence[TrueEnd]) -> TrueEnd | None:
    near = [end for end in ends if end.is_at(done.positions[climb.first])]
    towards = done.positions[min(climb.first + 12, len(done.positions) - 1)][2]
    goes = _UP if towards > done.positions[climb.first][2] else _DOWN
    return next((end for end in near if end.goes == goes), near[0] if near else None)


def random_start(world: SimulatedWorld, storeys: Sequence[float], steps: int, seed: int) -> Episode:
    """A start anywhere on a storey of a building."""
    assert isinstance(world.walkable, NavmeshSurface)  # the robot climbs
    rng, floor = np.random.default_rng(seed), world.walkable.floor
    level = np.abs(floor[:, 2][:, None] - np.array(storeys)).min(axis=1) <= _ON_FLOOR_M
    x, y, z = floor[level][rng.integers(level.sum())]
    yaw = rng.uniform(-math.pi, math.pi)
    pose = Pose2(float(x), float(y), float(yaw))
    return Episode(str(seed), "", NOTHING, pose, start_z=float(z), max_steps=steps)


def at_the_head(plan: FloorPlan, above: FloorPlan, steps: int) -> Episode:
    """A start at the head of stairs down, facing them."""
    assert plan.stairwell is not None
    (x, y), (dx, dy) = _head(plan.stairwell)
    pose = Pose2(x - _FROM_HEAD_M * dx, y - _FROM_HEAD_M * dy, math.atan2(dy, dx))
    return Episode("head", "", NOTHING, pose, start_z=above.floor_z, max_steps=steps)


def falls(done: Walk, plan: FloorPlan, config: HyPerNavConfig) -> dict[str, int]:
    """How often a step led over the edge of the floor above, or would have if it were let."""
    assert plan.stairwell is not None
    well, ahead_m = plan.stairwell.well, config.embodiment.motion.forward_m
    near_m = 2.0 * config.embodiment.body.radius_m
    counts = Counter[str](steps=len(done.traces), falls=0, near=0)
    for trace, (x, y, _), yaw in zip(done.traces, done.positions, done.headings, strict=True):
        counts["near"] += any(_holds(one.grown(near_m), x, y) for one in well)
        if trace.action is Action.MOVE_FORWARD:
            ahead = x + ahead_m * math.cos(yaw), y + ahead_m * math.sin(yaw)
            counts["falls"] += any(_holds(one, *ahead) for one in well)
    return dict(counts)


def _holds(rect: Rect, x: float, y: float) -> bool:
    return rect.x0 < x < rect.x1 and rect.y0 < y < rect.y1


def measured(number: int, steps: int, *, is_wheeled: bool) -> dict[str, int]:
    """One building as counts."""
    building = Building("storeys", number)
    scene, plans = cached_building(building), storeys_of(building)
    config = settings()
    if not is_wheeled:
        robot = config.embodiment.model_copy(update={"body": CLIMBING_BODY})
        config = config.model_copy(update={"embodiment": robot})
    drawing = RenderConfig(colours=False, antialias=False, threads=1)
    with closing(CpuRenderer(scene, drawing)) as renderer:
        world = SimulatedWorld(scene, config.world, config.embodiment, renderer=renderer)
        if is_wheeled:
            return falls(
                walk(world, config, at_the_head(plans[0], plans[1], steps)), plans[0], config
            )
        start = random_start(world, scene.storeys, steps, number)
        return measures(walk(world, config, start), true_ends(plans))


def table(counts: Counter[str], buildings: int) -> Iterator[str]:
    """What `measures` gave, summed over buildings, as lines."""
    for goes in (_UP, _DOWN):
        true, false = counts[f"{goes} true"], counts[f"{goes} false"]
        near, found = counts[f"{goes} near"], counts[f"{goes} near and found"]
        yield (
            f"{goes}: precision {true}/{true + false}, recall within {_NEAR_M:g} m {found}/{near}, "
            f"taken {counts[f'{goes} taken']}/{counts[f'{goes} tried']} tries, false "
            f"{false / buildings:.2f} a building, {counts[f'{goes} false at the end']} at the end"
        )
    yield f"elsewhere: taken {counts['stray taken']}/{counts['stray tried']} tries"


def main(
    first: Annotated[int, tyro.conf.Positional],
    last: Annotated[int, tyro.conf.Positional],
    /,
    out: Path,
    steps: int = 400,
    falls: bool = False,
    workers: int = 1,
) -> None:
    """Measure the stairs of buildings.

    Args:
        first: Number of the first building of ``storeys:N``.
        last: Number after the last one.
        out: Folder of the results, one line a building.
        steps: Number of steps in a building.
        falls: Whether a robot that can't climb is set at the head of stairs.
        workers: Number of processes.
    """
    out.mkdir(parents=True, exist_ok=True)
    file = out / ("falls.jsonl" if falls else "walks.jsonl")
    lines = file.read_text().splitlines() if file.exists() else []
    done = {one["building"]: one for one in map(json.loads, lines)}
    with (
        ProcessPoolExecutor(workers, multiprocessing.get_context("spawn")) as pool,
        file.open("a") as log,
    ):
        left = [number for number in range(first, last) if number not in done]
        runs = {pool.submit(measured, one, steps, is_wheeled=falls): one for one in left}
        for run in as_completed(runs):
            done[runs[run]] = {"building": runs[run], **run.result()}
            log.write(json.dumps(done[runs[run]]) + "\n")
            log.flush()
            print(done[runs[run]], flush=True)
    chosen = [one for number, one in done.items() if first <= number < last]
    counts = sum(map(Counter[str], chosen), Counter[str]())
    print(f"{len(chosen)} buildings, {counts['steps']} steps")
    if falls:
        print(f"falls: {counts['falls']}; {counts['near']} steps at the edge")
    else:
        print(*table(counts, len(chosen)), sep="\n")


if __name__ == "__main__":
    tyro.cli(main)
