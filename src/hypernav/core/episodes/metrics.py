"""Measures of an episode, exactly as habitat-lab computes them.

Source: habitat-lab, ``habitat/tasks/nav/nav.py`` (``Success``, ``SPL``, ``SoftSPL``,
``DistanceToGoal``) and Anderson et al., "On Evaluation of Embodied Navigation Agents", 2018.
"""

import math
from dataclasses import dataclass

SUCCESS_DISTANCE_M = 0.1
"""Habitat's success distance, geodesic: a STOP within it of a view point is a success."""


@dataclass(frozen=True)
class EpisodeMetrics:
    """Measures of one episode.

    Attributes:
        success: Whether the agent stopped within the success distance of a view point.
        spl: Success weighted by path length.
        soft_spl: SPL with progress towards the goal in place of success.
        distance_to_goal_m: Geodesic distance to the nearest view point, metres; infinite if there
            is none.
        shortest_path_m: Geodesic distance to the nearest view point at the start, metres.
        path_length_m: Length of the path driven, summed over all steps, metres.
    """

    success: bool
    spl: float
    soft_spl: float
    distance_to_goal_m: float
    shortest_path_m: float
    path_length_m: float


def measure(
    *,
    stopped: bool,
    distance_to_goal_m: float,
    shortest_path_m: float,
    path_length_m: float,
    success_distance_m: float,
) -> EpisodeMetrics:
    """Compute the measures of an episode from its lengths, all geodesic metres.

    Special cases of the divisions: a start at the goal counts as an efficient path, and a goal
    that no path leads to (infinite distance) can be neither reached nor approached.
    """
    reachable = math.isfinite(shortest_path_m)
    success = stopped and reachable and distance_to_goal_m < success_distance_m
    longest = max(shortest_path_m, path_length_m)
    if not reachable:
        efficiency = 0.0
    elif longest == 0.0:
        efficiency = 1.0
    else:
        efficiency = shortest_path_m / longest
    if not reachable or not math.isfinite(distance_to_goal_m):
        progress = 0.0
    elif shortest_path_m == 0.0:
        progress = 1.0 if distance_to_goal_m == 0.0 else 0.0
    else:
        progress = max(0.0, 1.0 - distance_to_goal_m / shortest_path_m)
    return EpisodeMetrics(
        success=success,
        spl=float(success) * efficiency,
        soft_spl=progress * efficiency,
        distance_to_goal_m=distance_to_goal_m,
        shortest_path_m=shortest_path_m,
        path_length_m=path_length_m,
    )
