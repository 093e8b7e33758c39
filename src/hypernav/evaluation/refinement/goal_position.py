"""The position that a goal area sends the robot to, and whether it is of any use in truth."""

import math
from enum import StrEnum

import numpy as np
from jaxtyping import Float64

from hypernav.build.presets import HyPerNavConfig
from hypernav.core.geometry.camera import optical_to_base
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.metrics import SUCCESS_DISTANCE_M
from hypernav.core.observation import Observation
from hypernav.core.world import GoalTruth, Renderer
from hypernav.perception.local.goal_area import GoalArea
from hypernav.planning.planner import Planner
from hypernav.worlds.goal_sight import MIN_VISIBLE_SHARE
from hypernav.worlds.simulation import SimulatedWorld


class GoalPosition(StrEnum):
    """What the goal position of a goal area turns out to be."""

    GOOD = "good"
    """The robot gets there, sees the goal, and a STOP there is a success."""
    TOO_FAR = "too far"
    """The robot gets there and sees the goal, but a STOP there is no success."""
    UNREACHABLE = "unreachable"
    """The robot's map has no path there, or in truth it cannot stand near it."""
    OCCLUDED = "occluded"
    """The robot gets there, and something hides the goal."""
    NONE = "none"
    """Nothing was left to go to."""


def judge_position(
    area: GoalArea,
    observation: Observation,
    grid: OccupancyGrid,
    world: SimulatedWorld,
    renderer: Renderer,
    goal: GoalTruth,
    config: HyPerNavConfig,
) -> GoalPosition:
    """What the position is that a robot would take from a goal area.

    It is the end of the path that the planner finds on the robot's map: the destination's cell that
    is nearest to the robot, moved to the nearest free cell (paper). It is unreachable where there
    is no path, where the path ends farther from the area than the robot stops, or where in truth no
    position that the robot gets to lies within that distance of it. It is occluded where a camera
    over the nearest such position, turned and tilted towards the middle of the area, shows less of
    the goal than counts as seen. These rules are ours.

    Args:
        area: Goal area.
        observation: Frame that it was made from.
        grid: The robot's map at that moment.
        world: World whose present episode the frame is from; where its robot is now doesn't matter.
        renderer: Renderer of the world's scene.
        goal: Instances and view points of the goal.
        config: Planner, body and stop distances.
    """
    planner = Planner(config.planning, config.embodiment.body)
    start = observation.robot.xy
    path = planner.plan(grid, start, area.entry_points)
    if path is None or path.gap_m > config.search.approach_gap_m:
        return GoalPosition.UNREACHABLE
    walkable, map_to_scene = world.walkable, world.map_to_scene
    here, end, middle = map_to_scene.apply(
        np.array([[*start, 0.0], [*path.end, 0.0], [*area.centre, area.height_m]])
    )
    positions = walkable.centres(walkable.component_of(float(here[0]), float(here[1])))
    gaps = np.linalg.norm(positions - end[:2], axis=1)
    if gaps.min(initial=math.inf) > config.search.stop_distance_m:
        return GoalPosition.UNREACHABLE
    x, y = (float(value) for value in positions[int(gaps.argmin())])
    camera = config.embodiment.camera
    lens_m = walkable.height_at(x, y) + camera.height_m
    view = renderer.render(camera.intrinsics, _gaze((x, y, lens_m), middle))
    goal_ids = [instance.id for instance in goal.instances]
    if float(np.isin(view.instance_ids, goal_ids).mean()) < MIN_VISIBLE_SHARE:
        return GoalPosition.OCCLUDED
    return GoalPosition.GOOD if goal.distance(x, y) < SUCCESS_DISTANCE_M else GoalPosition.TOO_FAR


def _gaze(lens: tuple[float, float, float], point: Float64[np.ndarray, "3"]) -> Transform:
    """Pose of a camera that is turned and tilted towards a point, scene frame."""
    ahead, left, up = (float(value) for value in point - np.array(lens))
    yaw, pitch = math.atan2(left, ahead), math.atan2(-up, math.hypot(ahead, left))
    tilted = optical_to_base(0.0, math.degrees(pitch))
    return Pose2(lens[0], lens[1], yaw).to_transform(lens[2]) @ tilted
