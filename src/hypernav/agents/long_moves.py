"""Moves that are made without looking: the actions they take, and what they are worth."""

import math

from hypernav.core.actions import Action
from hypernav.core.embodiment import MotionConfig
from hypernav.core.exploring.exploration import Destination
from hypernav.core.geometry.transforms import Pose2

_PAPER = MotionConfig()
"""Actions that moves are counted in, whatever the robot's own: 0.5 m and 30 degrees."""


def actions_to(destination: Destination, robot: Pose2, motion: MotionConfig) -> list[Action]:
    """The actions of a move: a turn, then straight ahead; as exactly as the robot's actions allow.

    Args:
        destination: End of the move, or a heading to turn to on the spot.
        robot: Pose of the robot.
        motion: Effect of its actions.
    """
    turn, length_m = _move(destination, robot)
    turns = round(math.degrees(abs(turn)) / motion.turn_angle_deg)
    side = Action.TURN_LEFT if turn > 0 else Action.TURN_RIGHT
    actions = [side] * turns + [Action.MOVE_FORWARD] * round(length_m / motion.forward_m)
    return actions or [Action.MOVE_FORWARD]


def paper_actions(destination: Destination, robot: Pose2) -> int:
    """Number of actions of 0.5 m and 30 degrees that a move stands for: 3 + 3 for 90° and 1.5 m."""
    turn, length_m = _move(destination, robot)
    turns = math.ceil(math.degrees(abs(turn)) / _PAPER.turn_angle_deg - 1e-6)
    return max(turns + math.ceil(length_m / _PAPER.forward_m - 1e-6), 1)


def _move(destination: Destination, robot: Pose2) -> tuple[float, float]:
    """Turn, radians, and way straight ahead, metres."""
    length_m = robot.distance_to(*destination.xy)
    if destination.face is None:
        return robot.bearing_to(*destination.xy), length_m
    return math.remainder(destination.face - robot.yaw, math.tau), length_m
