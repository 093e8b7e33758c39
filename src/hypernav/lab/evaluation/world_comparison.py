"""Compares our simulator with habitat-sim at random poses; needs both."""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from hypernav.core.embodiment import Embodiment
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.world import Position, Simulator

DEPTH_M = 0.05
STEP_M = 1e-3
PATH_SHARE = 1e-3
LEAST_DEPTH_SHARE = 0.97


@dataclass(frozen=True)
class PoseComparison:
    """Both simulators at one pose.

    Attributes:
        position: Position of the robot, scene frame, metres.
        yaw: Its heading, radians.
        color_difference: Mean difference of the colour images, 0 to 255.
        depth_share: Share of the pixels whose depths differ by less than 5 cm.
        label_share: Share of the pixels that show the same instance.
        step_m: Distance between the ends of a step forward, metres; the larger one of the steps
            with and without sliding.
        path_m: Geodesic distance to another position in habitat-sim, metres.
        own_path_m: The same in our simulator.
    """

    position: Position
    yaw: float
    color_difference: float
    depth_share: float
    label_share: float
    step_m: float
    path_m: float
    own_path_m: float

    @property
    def is_same(self) -> bool:
        """Whether depths, steps and paths agree as closely as they should."""
        paths = self.path_m == self.own_path_m or (
            abs(self.path_m - self.own_path_m) <= PATH_SHARE * max(self.path_m, 1.0)
        )
        return self.depth_share >= LEAST_DEPTH_SHARE and self.step_m <= STEP_M and paths


_ANY = Goal("position")


def compare_worlds(
    habitat: Simulator, native: Simulator, robot: Embodiment, poses: int, rng: np.random.Generator
) -> Iterator[PoseComparison]:
    """Compare two worlds of one scene at random poses.

    Args:
        habitat: habitat-sim's world.
        native: Our own.
        robot: The robot in both.
        poses: Number of poses.
        rng: Generator of the poses.
    """
    surface = habitat.truth.walkable
    points = [surface.random_point(rng) for _ in range(poses + 1)]
    places = [(x, y, surface.height_at(x, y)) for x, y in points]
    for here, there in itertools.pairwise(places):
        yaw = float(rng.uniform(-math.pi, math.pi))
        yield _compare(habitat, native, robot, here, there, yaw)


def _compare(
    habitat: Simulator,
    native: Simulator,
    robot: Embodiment,
    here: Position,
    there: Position,
    yaw: float,
) -> PoseComparison:
    scenes, pose = (habitat.truth, native.truth), Pose2(here[0], here[1], yaw)
    camera_to_scene = pose.to_transform(here[2]) @ robot.camera.camera_to_base
    theirs, ours = (scene.view_from(camera_to_scene) for scene in scenes)
    length = robot.motion.forward_m
    dx, dy = length * math.cos(yaw), length * math.sin(yaw)
    steps = [
        math.dist(*(scene.walkable.move(here, dx, dy, sliding=sliding) for scene in scenes))
        for sliding in (False, True)
    ]
    goal = np.array([there])
    paths = [scene.goal_truth(_ANY, goal).distance(*here) for scene in scenes]
    colors = theirs.rgb.astype(np.int16) - ours.rgb.astype(np.int16)
    return PoseComparison(
        position=here,
        yaw=yaw,
        color_difference=float(np.abs(colors).mean()),
        depth_share=float((np.abs(theirs.depth - ours.depth) < DEPTH_M).mean()),
        label_share=float((theirs.instance_ids == ours.instance_ids).mean()),
        step_m=max(steps),
        path_m=paths[0],
        own_path_m=paths[1],
    )
