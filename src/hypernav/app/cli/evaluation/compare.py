"""The command `hypernav compare`: our simulator and habitat-sim, pose by pose."""

import os
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import numpy as np

from hypernav.app.build.data.scenes import load_scene
from hypernav.app.build.our_worlds import in_habitat, in_our_own
from hypernav.app.build.presets import preset
from hypernav.app.cli.options.agent import check_steps_and_seed
from hypernav.app.cli.options.commands import CompareOptions
from hypernav.app.cli.screen.terminal import Terminal
from hypernav.core.config import check_option
from hypernav.core.embodiment import BodyConfig
from hypernav.core.errors import SceneError
from hypernav.lab.datasets.benchmarks import BENCHMARKS
from hypernav.lab.evaluation.world_comparison import PoseComparison, compare_worlds
from hypernav.simulator.worlds.habitat import navmesh_of, require_habitat
from hypernav.simulator.worlds.navmesh.robot_navmesh import is_computed

_MOST_POSES = 10_000


def run(options: CompareOptions) -> int:
    """Run the command.

    Returns:
        0 if the simulators agree at every pose, 1 if they don't.

    Raises:
        MissingExtraError: habitat-sim is not installed.
        SceneError: The scene is missing or can't be opened.
    """
    check_steps_and_seed(None, options.seed)
    check_option("--poses", options.poses, (1, _MOST_POSES), "poses that are compared")
    if not os.path.isfile(options.scene):
        raise SceneError(f"{options.scene}: no such scene file; check the path")
    require_habitat()
    console = Terminal(stderr=False, soft_wrap=True)
    robot = BENCHMARKS[options.benchmark].embodiment
    config = preset("default").model_copy(update={"embodiment": robot})
    scene_id = str(options.scene)
    with console.status("opening the scene in both simulators …"):
        scene = load_scene(scene_id)
        navmesh = navmesh_of(scene, options.scene)
        # Elsewhere an exported house uses our own walkable surface; here both use the same one.
        scene = replace(scene, navmesh=navmesh)
        if navmesh is None:  # and where there is none, both compute it
            walked = config.world.model_copy(update={"navmesh": "robot"})
            config = config.model_copy(update={"world": walked})
        native = in_our_own(scene, config, threads=1)
        habitat = in_habitat(scene, options.scene, config)
    console.print(_walked_on(navmesh, robot.body), markup=False)
    rng = np.random.default_rng(options.seed)
    with closing(native), closing(habitat):
        found = []
        for comparison in compare_worlds(habitat, native, robot, options.poses, rng):
            console.print(_line(comparison), markup=False)
            found.append(comparison)
    same = sum(comparison.is_same for comparison in found)
    console.print(f"{same} of {len(found)} poses agree in depth, steps and paths", markup=False)
    return 0 if same == len(found) else 1


def _walked_on(navmesh: Path | None, body: BodyConfig) -> str:
    if navmesh is None:
        return "there is no navigation mesh beside the scene: each computes one for the robot"
    if is_computed(navmesh, body, "auto"):
        return f"{navmesh.name} was made for another robot: each computes a mesh for this one"
    return f"both walk on {navmesh.name}"


def _line(comparison: PoseComparison) -> str:
    x, y, z = comparison.position
    mark = "ok  " if comparison.is_same else "DIFF"
    return (
        f"{mark} ({x:7.2f}, {y:7.2f}, {z:6.2f}) {np.degrees(comparison.yaw):6.1f}°: "
        f"colours {comparison.color_difference:5.1f}/255, "
        f"depth {100.0 * comparison.depth_share:5.1f} %, "
        f"labels {100.0 * comparison.label_share:5.1f} %, "
        f"step {1000.0 * comparison.step_m:.2f} mm, "
        f"path {comparison.path_m:.3f} m, ours {comparison.own_path_m:.3f} m"
    )
