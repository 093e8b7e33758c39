"""Lengths of true paths to the goal from positions in the robot's ``map`` frame."""

import math

import numpy as np

from hypernav.core.episode import PathLeft
from hypernav.lab.episodes.trial import Trial


def true_paths(trial: Trial) -> PathLeft | None:
    """The function that computes these lengths in an episode; None in a world without ground truth.

    A position where the robot can't stand is replaced by the nearest where it can, and the gap is
    added to the path. Positions are by odometry, so they drift with it. If floors lie above each
    other, the robot's present floor is meant.
    """
    referee, truth = trial.referee, trial.world.truth
    if referee is None or truth is None:
        return None

    def path_left_m(x: float, y: float) -> float:
        scene_x, scene_y, _ = truth.map_to_scene.apply(np.array([[x, y, 0.0]]))[0].tolist()
        z = truth.position[2]
        gap_m = 0.0
        if not truth.walkable.is_standable(scene_x, scene_y, z):
            asked = scene_x, scene_y
            scene_x, scene_y, z = truth.walkable.nearest_standable(scene_x, scene_y, z)
            gap_m = math.dist(asked, (scene_x, scene_y))
        return gap_m + referee.goal.distance(scene_x, scene_y, z)

    return path_left_m
