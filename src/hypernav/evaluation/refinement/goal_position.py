"""The position that a goal area sends the robot to, and whether it is of any use in truth."""

import math
from enum import StrEnum

import numpy as np
from jaxtyping import Float64
from scipy.spatial import KDTree

from hypernav.build.presets import HyPerNavConfig
from hypernav.core.geometry.camera import optical_to_base
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.metrics import SUCCESS_DISTANCE_M
from hypernav.core.world import GoalTruth, Renderer
from hypernav.mapping.memory.goal_area import GoalArea
from hypernav.worlds.goal_sight import MIN_VISIBLE_SHARE
from hypernav.worlds.simulation import SimulatedWorld


class GoalPosition(StrEnum):
    """What the goal position of a goal area turns out to be."""

    GOOD = "good"
    """The robot gets there, sees the goal, and a STOP there is a success."""
    TOO_FAR = "too far"
    """The robot gets there and sees the goal, but a STOP there is no success."""
    UNREACHABLE = "unreachable"
    """In truth the robot cannot get near it."""
    OCCLUDED = "occluded"
    """The robot gets there, and something hides the goal."""
    NONE = "none"
    """No frame gave a goal area."""


def judge_position(
    area: GoalArea,
    robot: Pose2,
    world: SimulatedWorld,
    renderer: Renderer,
    goal: GoalTruth,
    config: HyPerNavConfig,
) -> GoalPosition:
    """What the position is that a robot would take from a goal area.

    Of the area's cells the one that is closest to the robot is where it goes (paper; with
    ``planning.targets=nearest-by-path`` whichever it gets to first), and it stops as soon as it is
    within ``search.stop_distance_m``: of all true positions within that distance, at the one with
    the shortest true path. Without any the area is unreachable. It is occluded where a camera over
    that position, turned and tilted towards the middle of the area, shows less of the goal than
    counts as seen. These rules are ours.

    Args:
        area: Goal area.
        robot: Pose of the robot, ``map`` frame.
        world: World of the episode; where its robot is now doesn't matter.
        renderer: Renderer of the world's scene.
        goal: Instances and view points of the goal.
        config: Choice among cells, stop distance and camera.
    """
    walkable, map_to_scene = world.walkable, world.map_to_scene
    cells = area.entry_points
    if config.planning.targets == "nearest-straight":
        cells = cells[[int(np.linalg.norm(cells - np.array(robot.xy), axis=1).argmin())]]
    here = _in_scene(np.array([robot.xy]), map_to_scene)
    positions = walkable.centres(walkable.component_of(*here[0].tolist()))
    gaps, _ = KDTree(_in_scene(cells, map_to_scene)[:, :2]).query(positions)
    near = positions[gaps <= config.search.stop_distance_m]
    if len(near) == 0:
        return GoalPosition.UNREACHABLE
    paths = walkable.goal_field(here)
    x, y = min(near.tolist(), key=lambda position: paths.distance(*position))
    camera = config.embodiment.camera
    lens_m = walkable.height_at(x, y) + camera.height_m
    middle = map_to_scene.apply(np.array([*area.centre, area.height_m]))
    view = renderer.render(camera.intrinsics, _gaze((x, y, lens_m), middle))
    goal_ids = [instance.id for instance in goal.instances]
    if float(np.isin(view.instance_ids, goal_ids).mean()) < MIN_VISIBLE_SHARE:
        return GoalPosition.OCCLUDED
    return GoalPosition.GOOD if goal.distance(x, y) < SUCCESS_DISTANCE_M else GoalPosition.TOO_FAR


def _in_scene(
    points: Float64[np.ndarray, "n 2"], map_to_scene: Transform
) -> Float64[np.ndarray, "n 3"]:
    lifted = np.column_stack([points, np.zeros(len(points))])
    return map_to_scene.apply(lifted)


def _gaze(lens: tuple[float, float, float], point: Float64[np.ndarray, "3"]) -> Transform:
    """Pose of a camera that is turned and tilted towards a point, scene frame."""
    ahead, left, up = (float(value) for value in point - np.array(lens))
    yaw, pitch = math.atan2(left, ahead), math.atan2(-up, math.hypot(ahead, left))
    tilted = optical_to_base(0.0, math.degrees(pitch))
    return Pose2(lens[0], lens[1], yaw).to_transform(lens[2]) @ tilted
