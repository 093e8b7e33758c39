"""Steps over stairs and landings, where the ground's edges are near on both sides."""

import math
from collections.abc import Collection

import numpy as np
from jaxtyping import Bool, Int64

from hypernav.core.embodiment import Action, MotionConfig
from hypernav.core.geometry.transforms import Pose2, wrap_angle
from hypernav.search.mapping.elevation_map import Ground
from hypernav.search.mapping.grid_kernels import travel_cells
from hypernav.search.mapping.stairs.flights import HALF_WIDTH_M
from hypernav.search.planning.costmap import LEAST_GAIN_M

_TURN_M = 0.12
"""Cost of a turn of 30 degrees, metres of path."""
_EDGE_COST = 3.0
"""Cost of a step for every metre that it comes nearer to an edge than the middle of stairs is."""
_FREED_M = 0.2
"""First part of a step, metres, that may lead out of where the robot should not be."""


def step_over_ground(
    ground: Ground,
    robot: Pose2,
    to: Bool[np.ndarray, "rows columns"],
    motion: MotionConfig,
    *,
    touching: bool = False,
    closed: Collection[int] = (),
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
        closed: Turns to the left after which no step leads on.

    Returns:
        The action; None if no step brings the robot nearer, or there is nothing to go to.
    """
    here = ground.nearest_reached(robot.xy)
    if here is None or not to.any():
        return None
    if touching:
        to_go = np.where(ground.reached, -2.0 * ground.clearance_m, np.inf)
    else:
        middle = np.where(to, ground.clearance_m, -1.0)
        row, column = np.unravel_index(int(middle.argmax()), middle.shape)
        to_go = travel_cells(ground.reached.astype(np.uint8), int(row), int(column))
        to_go *= ground.grid.resolution_m
    narrow_m = np.maximum(HALF_WIDTH_M - ground.clearance_m.astype(np.float64), 0.0)
    ahead = {
        turns: line
        for turns, line in _open_steps(ground, robot, motion).items()
        if turns not in closed
    }
    for edge_cost in (_EDGE_COST, 0.0):  # the way may lead through where it is narrow
        now_m = float(to_go[here]) + edge_cost * float(narrow_m[here])
        most_m = math.inf if touching else now_m - LEAST_GAIN_M
        costs = {
            turns: left_m + _TURN_M * abs(turns) * (motion.turn_angle_deg / 30.0)
            for turns, line in ahead.items()
            if (left_m := float(to_go[line][-1] + edge_cost * narrow_m[line].max())) < most_m
        }
        if costs:
            turns = min(costs, key=lambda one: costs[one])
            if turns == 0:
                return Action.MOVE_FORWARD
            return Action.TURN_LEFT if turns > 0 else Action.TURN_RIGHT
    return None


def _open_steps(
    ground: Ground, robot: Pose2, motion: MotionConfig
) -> dict[int, tuple[Int64[np.ndarray, " n"], ...]]:
    """Rows and columns of the cells of each step that is open, by turns to the left before it."""
    count = max(math.ceil(motion.forward_m / ground.grid.resolution_m), 1)
    share = np.linspace(_FREED_M / motion.forward_m, 1.0, count)[:, None]
    half = motion.turns_of_a_circle // 2
    steps = dict[int, tuple[Int64[np.ndarray, " n"], ...]]()
    for turns in sorted(range(-half + 1, half + 1), key=abs):
        yaw = wrap_angle(robot.yaw + turns * math.radians(motion.turn_angle_deg))
        end = Pose2(robot.x, robot.y, yaw).ahead(motion.forward_m)
        way = np.array(robot.xy) + share * (np.array(end.xy) - np.array(robot.xy))
        cells = ground.grid.cells_of(way)
        if ground.grid.contains(cells).all() and ground.reached[tuple(cells.T)].all():
            steps[turns] = tuple(cells.T)
    return steps
