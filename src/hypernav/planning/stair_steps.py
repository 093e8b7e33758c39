"""Steps over stairs and landings, where the ground's edges are near on both sides."""

import math

import numpy as np
from jaxtyping import Bool

from hypernav.core.actions import Action
from hypernav.core.embodiment import MotionConfig
from hypernav.core.geometry.transforms import Pose2, wrap_angle
from hypernav.mapping.distance_kernels import travel_cells
from hypernav.mapping.ground import Ground

_TURN_M = 0.12
"""Cost of a turn of 30 degrees, metres of path."""
_MIDDLE_M = 0.42
"""Distance from edges, metres, below which a step costs more: the robot keeps to the middle."""
_EDGE_COST = 3.0
"""Cost of a step for every metre that it comes nearer to an edge than that."""
_LEAST_GAIN_M = 0.05
_FREED_M = 0.2
"""First part of a step, metres, that may lead out of where the robot should not be."""


def step_over_ground(
    ground: Ground,
    robot: Pose2,
    to: Bool[np.ndarray, "rows columns"],
    motion: MotionConfig,
    *,
    touching: bool = False,
) -> Action | None:
    """The next turn or step towards the middle of a part of the ground.

    All headings that turns lead to are compared by what is left to go after one step forward.

    Args:
        ground: The ground around the robot.
        robot: Pose of the robot.
        to: Mask of the cells to go to, which the robot can reach.
        motion: Length of a step and angle of a turn.
        touching: Whether the robot has just bumped into something: then it first goes to where most
            room is, since beside a wall that it touches it may not get on.

    Returns:
        The action; None if no step brings the robot nearer.
    """
    size = ground.grid.resolution_m
    away = np.where(to, ground.clearance_m, -1.0)
    aim = np.unravel_index(int(away.argmax()), away.shape)
    if touching:
        to_go = np.where(ground.reached, -2.0 * ground.clearance_m, np.inf)
    else:
        to_go = travel_cells(ground.reached.astype(np.uint8), int(aim[0]), int(aim[1])) * size
    here = ground.nearest_reached(robot.xy)
    if here is None:
        return None
    turns = _best_turns(ground, robot, to_go, here, motion, _EDGE_COST, touching=touching)
    if turns is None and not touching:  # the way may lead through where it is narrow
        turns = _best_turns(ground, robot, to_go, here, motion, 0.0, touching=touching)
    if turns is None:
        return None
    if turns == 0:
        return Action.MOVE_FORWARD
    return Action.TURN_LEFT if turns > 0 else Action.TURN_RIGHT


def _best_turns(
    ground: Ground,
    robot: Pose2,
    to_go: np.ndarray,
    here: tuple[int, int],
    motion: MotionConfig,
    edge_cost: float,
    *,
    touching: bool,
) -> int | None:
    """Number of turns to the left before the best step; None if no step brings the robot nearer."""
    turn, turns = math.radians(motion.turn_angle_deg), motion.turns_of_a_circle
    least_m = math.inf
    if not touching:
        least_m = float(to_go[here]) + edge_cost * _narrow_m(ground.clearance_m[here])
    best, best_turns = math.inf, None
    for k in sorted(range(-(turns // 2) + 1, turns // 2 + 1), key=abs):
        pose = Pose2(robot.x, robot.y, wrap_angle(robot.yaw + k * turn))
        left_m = _left_after(ground, pose, to_go, motion.forward_m, edge_cost)
        cost = left_m + _TURN_M * abs(k) * (motion.turn_angle_deg / 30.0)
        if left_m < least_m - _LEAST_GAIN_M and cost < best:
            best, best_turns = cost, k
    return best_turns


def _left_after(
    ground: Ground, pose: Pose2, to_go: np.ndarray, forward_m: float, edge_cost: float
) -> float:
    """What is left to go after a step, metres, dearer near edges; infinite if it is not open."""
    end = pose.ahead(forward_m)
    count = max(math.ceil(forward_m / ground.grid.resolution_m), 1)
    share = np.linspace(_FREED_M / forward_m, 1.0, count)[:, None]
    line = ground.grid.cells_of(np.array(pose.xy) + share * (np.array(end.xy) - np.array(pose.xy)))
    if not ground.grid.contains(line).all() or not ground.reached[tuple(line.T)].all():
        return math.inf
    on_line = tuple(line.T)
    return float(to_go[on_line][-1]) + edge_cost * _narrow_m(ground.clearance_m[on_line].min())


def _narrow_m(clearance_m: np.floating) -> float:
    """How much nearer to an edge than wanted a clearance is, metres."""
    return max(_MIDDLE_M - float(clearance_m), 0.0)
