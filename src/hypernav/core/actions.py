"""Actions of an agent."""

from enum import IntEnum


class Action(IntEnum):
    """Discrete actions with Habitat's numbers."""

    STOP = 0
    MOVE_FORWARD = 1
    TURN_LEFT = 2
    TURN_RIGHT = 3
