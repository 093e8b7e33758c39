"""The position that a goal area sends the robot to, and whether it is really useful."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64
from scipy.spatial import KDTree

from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.episode import SUCCESS_DISTANCE_M
from hypernav.core.geometry.camera import optical_to_base
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.world import GoalTruth, SceneTruth
from hypernav.lab.episodes.goal_sight import MIN_VISIBLE_SHARE
from hypernav.search.memory.goal_area import GoalArea


@dataclass(frozen=True)
class GoalPosition:
    """Facts about the position that a goal area sends the robot to; each is independent.

    Attributes:
        in_obstacle: The area's cell that the robot goes to is no position to stand at: an obstacle
            is nearer than the robot's radius.
        unreachable: No path leads to within the stop distance of that cell. So it is with a goal
            area that obstacles enclose, where the paper's A* fails.
        occluded: From where the robot ends, something hides the goal. It is no measure of the
            paper, whose occlusion is one of the image that gives the area.
        fails: A STOP there is no success.
    """

    in_obstacle: bool
    unreachable: bool
    occluded: bool
    fails: bool


def judge_position(
    area: GoalArea, robot: Pose2, scene: SceneTruth, goal: GoalTruth, config: HyPerNavConfig
) -> GoalPosition:
    """Judge the position that a robot would go to for a goal area.

    It goes to the area's cell that is closest to the robot (paper; with
    ``planning.targets=nearest-by-path`` to the one that it reaches first, and the goal is in an
    obstacle only if all of them are). It stops as soon as it is within
    ``search.stop_distance_m``: of all true positions within that distance, at the one with the
    shortest true path. If there is none, the area is unreachable, and the robot ends at the free
    position nearest to the cell (paper: a destination inside an obstacle moves there). The goal is
    occluded if a camera above the end, turned and tilted towards the middle of the area, shows less
    of it than counts as seen. The paper says what the two problems are and not by which rule its
    figures count them; these rules are ours.

    Args:
        area: Goal area.
        robot: Pose of the robot, ``map`` frame.
        scene: The scene of the episode; where its robot is now doesn't matter.
        goal: Instances and view points of the goal.
        config: Choice among cells, stop distance and camera.
    """
    walkable, map_to_scene = scene.walkable, scene.map_to_scene
    cells = area.entry_points
    if config.planning.targets == "nearest-straight":
        cells = cells[[int(np.linalg.norm(cells - np.array(robot.xy), axis=1).argmin())]]
    targets = _in_scene(cells, map_to_scene)[:, :2]
    here = _in_scene(np.array([robot.xy]), map_to_scene)
    positions = walkable.centres(walkable.component_of(*here[0].tolist()))
    gaps, _ = KDTree(targets).query(positions)
    near = positions[gaps <= config.search.stop_distance_m]
    unreachable = len(near) == 0
    paths = scene.goal_truth(goal.goal, here)
    x, y = min(
        (positions[[int(np.argmin(gaps))]] if unreachable else near).tolist(),
        key=lambda position: paths.distance(*position),
    )
    camera = config.embodiment.camera
    lens_m = walkable.height_at(x, y) + camera.height_m
    middle = map_to_scene.apply(np.array([*area.centre, area.height_m]))
    view = scene.view_from(_gaze((x, y, lens_m), middle), colours=False)
    goal_ids = [instance.id for instance in goal.instances]
    return GoalPosition(
        in_obstacle=not any(walkable.is_standable(*target) for target in targets.tolist()),
        unreachable=unreachable,
        occluded=float(np.isin(view.instance_ids, goal_ids).mean()) < MIN_VISIBLE_SHARE,
        fails=unreachable or not goal.distance(x, y) < SUCCESS_DISTANCE_M,
    )


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
