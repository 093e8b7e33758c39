"""From a path to the next discrete action."""

import math

import numpy as np
from jaxtyping import Float64

from hypernav.core.actions import Action
from hypernav.core.geometry import Pose2
from hypernav.planning.astar_kernels import dearest_on_line, ways_to_go
from hypernav.planning.config import PlanningConfig
from hypernav.planning.planner import Path
from hypernav.planning.terrain import Terrain

_TURN_COST_M = 0.03
"""What a turn weighs against a longer way: enough to decide ties and to keep a choice."""
_LEAST_GAIN_M = 0.05
_KNOT_SPACING_M = 0.10


def steer_to_waypoint(config: PlanningConfig, robot: Pose2, path: Path) -> Action | None:
    """The paper's follower: turn if the next waypoint is too far off, else go.

    Returns:
        The action; None when the end of the path is reached.
    """
    ahead = [p for p in path.waypoints[1:] if robot.distance_to(*p) > config.waypoint_tolerance_m]
    if not ahead or robot.distance_to(*path.end) <= config.waypoint_tolerance_m:
        return None
    bearing = robot.bearing_to(*ahead[0])
    if abs(bearing) <= math.radians(config.heading_tolerance_deg) + 1e-9:
        return Action.MOVE_FORWARD
    return Action.TURN_LEFT if bearing > 0.0 else Action.TURN_RIGHT


def steer_by_rollout(
    config: PlanningConfig, robot: Pose2, path: Path, terrain: Terrain
) -> Action | None:
    """Of all headings the robot can turn to, take the one whose step leaves the shortest way.

    A heading whose step touches an inflated obstacle is no choice. Since a turn costs a little,
    the choice stays the same while the robot turns to it.

    Returns:
        The action; None when no step brings the robot nearer to the end of the path.
    """
    turns = round(360.0 / config.turn_angle_deg)
    offsets = np.arange(turns) - turns // 2
    headings = robot.yaw + offsets * math.radians(config.turn_angle_deg)
    here = np.array(terrain.continuous(*robot.xy))
    step = config.forward_m / terrain.grid.resolution_m
    ends = here + step * np.stack([np.sin(headings), np.cos(headings)], axis=1)
    knots, to_go = _knots(path, terrain)
    costs = _freed_around(terrain.costs, here)
    way = ways_to_go(costs, np.vstack([ends, here]), knots, to_go) * terrain.grid.resolution_m
    now, after = way[-1], way[:-1]
    hits = np.array([np.isinf(dearest_on_line(costs, *here, *end)) for end in ends])
    value = np.where(hits, np.inf, after + _TURN_COST_M * np.abs(offsets))
    best = int(value.argmin())
    if np.isinf(value[best]):
        return steer_to_waypoint(config, robot, path)
    if after[best] > now - _LEAST_GAIN_M:
        return None
    if offsets[best] == 0:
        return Action.MOVE_FORWARD
    return Action.TURN_LEFT if offsets[best] > 0 else Action.TURN_RIGHT


def _knots(
    path: Path, terrain: Terrain
) -> tuple[Float64[np.ndarray, "knots 2"], Float64[np.ndarray, "knots"]]:
    """Points along a path in continuous cells, and the length from each to the end in cells."""
    corners = np.array([terrain.continuous(*point) for point in path.waypoints])
    lengths = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    travelled = np.concatenate([[0.0], np.cumsum(lengths)])
    spacing = _KNOT_SPACING_M / terrain.grid.resolution_m
    count = max(int(travelled[-1] / spacing), 1) + 1
    along = np.linspace(0.0, travelled[-1], count)
    knots = np.stack([np.interp(along, travelled, corners[:, i]) for i in range(2)], axis=1)
    return knots, travelled[-1] - along


def _freed_around(costs: np.ndarray, here: Float64[np.ndarray, "2"], reach: int = 3) -> np.ndarray:
    """The same costs, with a way out where the robot itself stands in an inflated obstacle."""
    row, column = int(here[0]), int(here[1])
    rows, columns = costs.shape
    if 0 <= row < rows and 0 <= column < columns and costs[row, column] > 0:
        return costs
    costs = costs.copy()
    around = costs[
        max(row - reach, 0) : row + reach + 1, max(column - reach, 0) : column + reach + 1
    ]
    around[around <= 0] = 1.0
    return costs
