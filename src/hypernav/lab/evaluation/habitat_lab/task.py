"""The parts of habitat-lab's ObjectNav task that a plan of a run doesn't have."""

from typing import Literal

from pydantic import Field

from hypernav.core.config import RoomConfig

SensorName = Literal["rgb", "depth", "semantic"]
"""A camera of the robot, by the name of its observation."""
ActionName = Literal["stop", "move_forward", "turn_left", "turn_right", "look_up", "look_down"]


class HabitatTask(RoomConfig):
    """Sensors, actions and rewards, by default those of habitat-lab's ObjectNav configurations.

    Attributes:
        sensors: Cameras of the robot. GPS, compass and the number of the goal are always there.
        actions: Names of the actions; an action's number is its index.
        normalize_depth: Whether depth is scaled from the sensor's range to the range 0 to 1.
        tilt_deg: Angle of ``look_up`` and ``look_down``, degrees.
        shuffle: Whether episodes come in an order drawn from the seed; those of one scene always
            come one after the other.
        slack_reward: Reward of every step (RL environments).
        success_reward: Reward of success (RL environments).
    """

    sensors: tuple[SensorName, ...] = ("rgb", "depth")
    actions: tuple[ActionName, ...] = (
        "stop",
        "move_forward",
        "turn_left",
        "turn_right",
        "look_up",
        "look_down",
    )
    normalize_depth: bool = True
    tilt_deg: float = Field(default=30.0, gt=0.0, le=90.0)
    shuffle: bool = False
    slack_reward: float = Field(default=-0.01, ge=-1000.0, le=1000.0)
    success_reward: float = Field(default=2.5, ge=-1000.0, le=1000.0)
