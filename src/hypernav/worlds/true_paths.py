"""The lengths of true paths to the goal, asked for in the frame that the robot knows."""

import numpy as np

from hypernav.core.episode_truth import PathLeft
from hypernav.core.world import SceneTruth
from hypernav.worlds.trial import Trial


def true_paths(trial: Trial) -> PathLeft | None:
    """The function that gives these lengths in an episode; None in a world without ground truth.

    A position where the robot can't stand counts as the nearest where it can, and the gap is part
    of the path. Odometry is taken at its word: where it drifts, so do the positions.
    """
    referee, truth = trial.referee, trial.world.truth
    if referee is None or truth is None:
        return None

    def path_left_m(x: float, y: float) -> float:
        scene_x, scene_y, _ = truth.map_to_scene.apply(np.array([[x, y, 0.0]]))[0]
        floor_x, floor_y, gap_m = _floor_near(truth, float(scene_x), float(scene_y))
        return gap_m + referee.goal.distance(floor_x, floor_y)

    return path_left_m


def _floor_near(truth: SceneTruth, x: float, y: float) -> tuple[float, float, float]:
    """Where the robot can stand nearest to a position, and how far away that is, metres."""
    if truth.walkable.is_standable(x, y):
        return x, y, 0.0
    centres = truth.walkable.centres()
    gaps_m = np.hypot(centres[:, 0] - x, centres[:, 1] - y)
    nearest = int(gaps_m.argmin())
    return float(centres[nearest, 0]), float(centres[nearest, 1]), float(gaps_m[nearest])
