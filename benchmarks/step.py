"""Time every part of a step, and the whole steps of a long search.

Run: python benchmarks/step.py [--data FOLDER] [--house houses:N]

Machines differ, so times are also given in units of one bare pass over a depth image, which counts
the points in each voxel.

The parts are timed on the recorded episode in small_house. Its poses are rendered again, so that
colour and labels are there too; an agent that looks for a chair is shown it as well, though it
would have driven elsewhere. The agent's other steps are those of a search of 1,000 steps in a large
generated house for a goal that is not there; when all is explored, it looks again. A robot that
climbs is shown the same world, which has no stairs.
"""

import os
import resource
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import tyro
from numba import njit
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from hypernav.app.build.agents import build_explorer, build_search
from hypernav.app.build.data.scenes import load_scene
from hypernav.app.build.presets import preset
from hypernav.core.components.abilities import Learns
from hypernav.core.embodiment import Action, BodyConfig
from hypernav.core.episode import Episode
from hypernav.core.exploring.exploration import ExplorationView
from hypernav.core.geometry.camera import optical_to_base
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.observation import LabelledPixels, Observation
from hypernav.core.trace import ExchangeLog
from hypernav.io.layered_config import layered
from hypernav.search.drawing.question_map import draw_question_map
from hypernav.search.mapping.blocks import blocks_of
from hypernav.search.mapping.reachable_area import ReachableArea, find_frontiers
from hypernav.search.mapping.top_down_kernels import count_points
from hypernav.search.memory.memory import Memory
from hypernav.search.perception.local.depth_cut import DepthCutSegmenter
from hypernav.search.perception.local.local_perception import LocalPerception
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from hypernav.search.planning.planner import Planner
from hypernav.simulator.houses.episodes.building_truth import CLIMBING_BODY
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer, RenderConfig
from hypernav.simulator.worlds.simulation import SimulatedWorld
from hypernav.simulator.worlds.surface.goal_regions import random_start

STEPS, LONG_STEPS = 500, 1000
RIVALS = ("vlfm", "navvlm", "vlmnav", "pivot", "dynavlm-style")
UNIT = "the unit: depth to distinct voxels"
TEST_DATA = Path(os.environ.get("HYPERNAV_TEST_DATA", "../shared/data"))


@dataclass
class Stopwatch:
    """Milliseconds of every timed call, by name."""

    times: dict[str, list[float]] = field(default_factory=dict)

    def __call__(self, name: str, call: Callable[..., Any], *arguments: Any) -> Any:
        """Time one call."""
        start = time.perf_counter()
        result = call(*arguments)
        self.times.setdefault(name, []).append((time.perf_counter() - start) * 1e3)
        return result


def main(data: Path = TEST_DATA, house: str = "houses:100007") -> None:
    """Print the table.

    Args:
        data: Folder of the test data.
        house: The building in which the agent searches.
    """
    config, watch = preset("default"), Stopwatch()
    observations = recorded(data, watch)
    local = LocalPerception(
        GroundTruthDetector(),
        DepthCutSegmenter(),
        config.local,
        config.embodiment.camera,
        cell_size_m=0.05,
    )
    clearance_m = config.planning.clearances_m(config.embodiment.body)[0]
    goal, floor = Goal("chair"), Memory(config.mapping, config.embodiment).floor
    planner = Planner(config.planning, config.embodiment.body)
    voxels = np.zeros(400 * 400 * 32, dtype=np.uint16)
    for step in range(STEPS):
        observation = observations[step % len(observations)]
        robot = observation.robot
        watch(UNIT, bare_pass, observation, voxels)
        watch("integrate", floor.integrate, observation)
        watch("local perception", local.look, observation, goal, floor)
        grid = floor.map.grid
        watch("frontiers", find_frontiers, grid, robot, config.mapping, clearance_m)
        reach = watch("reachable area", ReachableArea.of, grid, robot, config.mapping, clearance_m)
        blocks = watch("blocks", blocks_of, reach, config.mapping)
        if step % 10 == 0:
            watch("draw overview", draw_question_map, grid, blocks, robot, floor.trajectory)
        far = max(blocks, key=lambda b: b.travel_m)
        target = np.array([far.destination])
        watch("plan to the farthest block", planner.plan, grid, robot.xy, target)
    explore_as_published(observations, watch)
    follow_recording(observations, watch)
    search_in_vain(watch, house, "agent step, long search", config.embodiment.body)
    search_in_vain(watch, house, "agent step, long search, climbing", CLIMBING_BODY)
    report(watch)


def explore_as_published(observations: list[Observation], watch: Stopwatch) -> None:
    """Time the explorers of the published methods, each with a map of its own.

    All but the models: a choice with a stand-in at every step and, where an explorer learns from
    every image, what an image costs. The map is in "integrate" above.
    """
    config, goal = preset("default"), Goal("something that is not there")
    for name in RIVALS:
        explorer = build_explorer(config, ExchangeLog(), name)
        floor = Memory(config.mapping, config.embodiment).floor
        for observation in observations:
            floor.integrate(observation)
            view = ExplorationView(
                goal, observation, floor.map.grid, floor.trajectory, notes=floor.search.notes
            )
            if isinstance(explorer, Learns):
                watch(f"{name}: image", explorer.learn, view)
            watch(f"{name}: choice", explorer.next_destination, view)


def bare_pass(observation: Observation, counts: NDArray[np.uint16]) -> int:
    """Count the points of a depth image in the voxels of 20 m x 20 m x 1.6 m, 0.05 m each."""
    camera, pose = observation.camera, observation.camera_to_map
    u, v = np.arange(camera.width) + 0.5 - camera.cx, np.arange(camera.height) + 0.5 - camera.cy
    turn = pose.rotation * 20.0
    across = (u[:, None] / camera.fx * turn[:, 0]).astype(np.float32)
    down = (v[:, None] / camera.fy * turn[:, 1] + turn[:, 2]).astype(np.float32)
    corner = np.array([*observation.robot.xy, 0.1]) - np.array([10.0, 10.0, 0.0])
    start = ((pose.translation - corner) * 20.0).astype(np.float32)
    return distinct_voxels(observation.depth, start, across, down, counts)


@njit(nogil=True)
def distinct_voxels(depth, start, across, down, counts):
    touched = np.empty(depth.size, dtype=np.int32)
    near, far = np.float32(0.5), np.float32(5.0)
    n = count_points(depth, near, far, start, across, down, 400, 32, counts, touched)
    for i in range(n):
        counts[touched[i]] = 0
    return n


def follow_recording(observations: list[Observation], watch: Stopwatch) -> None:
    """Time the agent's steps on the recorded episode, which is full of chairs."""
    agent = build_search(preset("default"), GroundTruthDetector(), ExchangeLog())
    agent.reset(Goal("chair"))
    for observation in observations:
        watch("agent step, recorded", agent.act, observation)


def search_in_vain(watch: Stopwatch, house: str, name: str, body: BodyConfig) -> None:
    """Time the agent's steps while it explores a whole house and takes its body for this one."""
    endless = ("search.end_when_explored=false", f"search.max_steps={LONG_STEPS}")
    config, goal = layered(preset("default"), assignments=endless), Goal("nothing of this kind")
    scene = load_scene(house)
    renderer = CpuRenderer(scene, RenderConfig(colours=False))  # ground truth needs none
    world = SimulatedWorld(scene, config.world, config.embodiment, renderer=renderer)
    robot = config.embodiment.model_copy(update={"body": body})
    config = config.model_copy(update={"embodiment": robot})
    agent = build_search(config, GroundTruthDetector(), ExchangeLog())
    agent.reset(goal)
    start = random_start(world.walkable, np.random.default_rng(0), None)
    observation = world.reset(Episode(house, "", goal, start), np.random.default_rng(0))
    for _ in range(LONG_STEPS):
        action = watch(name, agent.act, observation)
        if action is None or action is Action.STOP:
            break
        observation = world.step(action)


def recorded(data: Path, watch: Stopwatch) -> list[Observation]:
    """The recorded frames, rendered again."""
    episode = np.load(data / "episodes" / "small_house.npz")
    scene = load_scene(str(data / "scenes" / "small_house" / "scene.glb"))
    renderer, config = CpuRenderer(scene), preset("default").embodiment
    labels = {i.id: i.label for i in scene.instances if i.label is not None}
    camera = config.camera.intrinsics
    observations: list[Observation] = []
    for _ in range(2):  # twice: light is computed where it is first seen
        observations = []
        for x, y, yaw in episode["xy_yaw"]:
            # The recording's frame is turned by 90 degrees against ours.
            pose = Pose2(-float(y), float(x), float(yaw) + np.pi / 2)
            camera_to_scene = pose.to_transform() @ optical_to_base(config.camera.height_m)
            view = watch("render", renderer.render, camera, camera_to_scene)
            in_range = is_measured(view.depth, config.camera.min_depth_m, config.camera.max_depth_m)
            observations.append(
                Observation(
                    rgb=view.rgb,
                    depth=np.where(in_range, view.depth, np.float32(0.0)),
                    camera=camera,
                    camera_to_map=camera_to_scene,
                    robot=pose,
                    truth=LabelledPixels(view.instance_ids, labels),
                )
            )
    watch.times["render"] = watch.times["render"][len(observations) :]
    return observations


def report(watch: Stopwatch) -> None:
    table = Table("what", "median ms", "95% ms", "in units", "95%", "first 100", "last 100", "n")
    unit = np.median(watch.times[UNIT][3:])
    for name, times in watch.times.items():
        warm = times[3:]  # the first calls load compiled code
        table.add_row(
            name,
            f"{np.median(warm):.2f}",
            f"{np.percentile(warm, 95):.2f}",
            f"{np.median(warm) / unit:.1f}",
            f"{np.percentile(warm, 95) / unit:.1f}",
            f"{np.median(warm[:100]):.2f}",
            f"{np.median(warm[-100:]):.2f}",
            str(len(warm)),
        )
    Console().print(table)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    Console().print(f"peak memory of this program {peak:.0f} MB")


if __name__ == "__main__":
    tyro.cli(main)
