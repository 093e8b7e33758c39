"""What a robot is told about a decision."""

import math

import numpy as np

from hypernav.core.actions import Action
from hypernav.core.embodiment import Embodiment
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.trace import Ending, StepTrace
from hypernav.robot.motion.config import DriveConfig
from hypernav.robot.motion.obstacles import MapObstacles
from hypernav.robot.motion.pure_pursuit import PurePursuit
from hypernav.robot.wire.replies import Reply, SearchEnding, Velocity

_SURROUNDINGS_M = 3.0
_SUGGESTED_S = 1.0
"""Time to reach the suggested velocity: a robot at standstill gets the full velocity."""
_ENDINGS = {Ending.FOUND: SearchEnding.FOUND, Ending.GAVE_UP: SearchEnding.GAVE_UP}


def reply_of(sequence: int, trace: StepTrace, grid: OccupancyGrid, robot: Embodiment) -> Reply:
    """The reply for a decision.

    Args:
        sequence: Number of the observation.
        trace: Decision of the agent.
        grid: Its map.
        robot: Body and actions of the robot.
    """
    ending = None if trace.ending is None else _ENDINGS[trace.ending]
    x, y, yaw = trace.pose
    obstacles = MapObstacles(_around(grid, x, y))
    clearance_m = float(obstacles.distances(np.array([[x, y]]))[0])
    return Reply(
        sequence=sequence,
        action=Action.STOP if trace.action is None else trace.action,
        destination=trace.destination,
        path=tuple(trace.path),
        clearance_m=round(clearance_m, 3) if clearance_m <= _SURROUNDINGS_M else None,
        velocity=None if ending else _suggested(Pose2(x, y, yaw), trace, obstacles, robot),
        mode=trace.mode,
        reason=trace.reason,
        done=ending is not None,
        ending=ending,
    )


def reply_out_of_steps(sequence: int) -> Reply:
    """The reply when the steps have run out."""
    return Reply(
        sequence=sequence,
        action=Action.STOP,
        reason=f"the limit of {sequence} steps is reached",
        done=True,
        ending=SearchEnding.GAVE_UP,
    )


def _suggested(
    pose: Pose2, trace: StepTrace, obstacles: MapObstacles, robot: Embodiment
) -> Velocity:
    """A velocity along the path; without a path, that of the action's rotation."""
    pursuit = PurePursuit(DriveConfig(), robot.body.radius_m)
    turn = math.radians(robot.motion.turn_angle_deg)
    if len(trace.path) > 1:
        found = pursuit.command(pose, trace.path, _SUGGESTED_S, obstacles)
    elif trace.action in (Action.TURN_LEFT, Action.TURN_RIGHT):
        found = pursuit.rotate(turn if trace.action is Action.TURN_LEFT else -turn, _SUGGESTED_S)
    else:
        found = pursuit.command(pose, (), _SUGGESTED_S)
    return Velocity(
        linear_m_s=round(found.linear_m_s, 4), angular_rad_s=round(found.angular_rad_s, 4)
    )


def _around(grid: OccupancyGrid, x: float, y: float) -> OccupancyGrid:
    """The part of a map around a position, at least one cell."""
    row, column = grid.cell_of(x, y)
    reach = math.ceil(_SURROUNDINGS_M / grid.resolution_m)
    rows, columns = grid.cells.shape
    bottom = min(max(row - reach, 0), rows - 1)
    left = min(max(column - reach, 0), columns - 1)
    top, right = max(row + reach + 1, bottom + 1), max(column + reach + 1, left + 1)
    size = grid.resolution_m
    origin = (grid.origin[0] + left * size, grid.origin[1] + bottom * size)
    cells = np.ascontiguousarray(grid.cells[bottom:top, left:right])
    return OccupancyGrid(cells, size, origin)
