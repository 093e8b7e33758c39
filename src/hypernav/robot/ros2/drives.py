"""The drives of a robot on a ROS 2 network: its own velocities, or a running Nav2."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from operator import attrgetter
from typing import Literal, Protocol, TypeVar

from hypernav.core.errors import ConfigError, RosNetworkError
from hypernav.robot.client.robot import Robot
from hypernav.robot.client.robot_client import MADE_SHARE
from hypernav.robot.driving.driven_robot import DrivenRobot
from hypernav.robot.ros2.config import Ros2Config
from hypernav.robot.ros2.nav2_robot import Nav2Robot
from hypernav.robot.ros2.network import Ros2Network
from hypernav.robot.ros2.sensing_robot import SensingRobot
from hypernav.robot.ros2.sensors import Ros2Sensors
from hypernav.robot.ros2.velocity_base import Ros2Base

_LOG = logging.getLogger(__name__)
_LARGE_AHEAD_M = 3.0
"""Distance to the next goal from which on driving unsupervised is worth a warning."""

Drive = Literal["cmd_vel", "nav2"]
"""Which program turns the agent's decisions into velocities: hypernav or Nav2."""
_UNUSED: dict[Drive, tuple[tuple[str, ...], str]] = {
    "cmd_vel": (("nav2", "topics.goal_pose", "topics.stop_cmd_vel", "topics.nav2_lock"), ""),
    "nav2": (("speed",), "; Nav2's own parameters limit the speed"),
}
"""Sections that each drive ignores, and what applies instead."""


def check_drive(drive: Drive, config: Ros2Config) -> None:
    """Refuse a configuration with which a drive cannot make the agent's motions or be stopped.

    Values that belong to the other drive only give a warning: one file may serve both.

    Raises:
        ConfigError: The tolerances for a reached goal are larger than a motion, or the topics that
            stop Nav2 are not separate from its own.
    """
    names, instead = _UNUSED[drive]
    set_all_the_same = [name for name in names if _is_set(config, name)]
    if set_all_the_same:
        without = ", ".join(set_all_the_same)
        _LOG.warning("%s: without effect with --drive %s%s", without, drive, instead)
    if drive == "nav2":
        _check_reached(config)
        _check_stops(config)


def _is_set(config: Ros2Config, name: str) -> bool:
    value = attrgetter(name)
    return value(config) != value(Ros2Config())


def _check_reached(config: Ros2Config) -> None:
    nav2, motion, lacks = config.nav2, config.embodiment.motion, 1.0 - MADE_SHARE
    for name, reached, made in (
        ("reached_m", nav2.reached_m, motion.forward_m),
        ("reached_deg", nav2.reached_deg, motion.turn_angle_deg),
    ):
        if reached >= lacks * made:
            option = "forward_m" if name == "reached_m" else "turn_angle_deg"
            raise ConfigError(
                f"nav2.{name} {reached:g}: a motion of {made:g} (embodiment.motion.{option}) that "
                f"lacks {reached:g} counts as blocked; expected less than {lacks * made:g}, and a "
                "goal checker of Nav2 whose tolerance is not above it"
            )


def _check_stops(config: Ros2Config) -> None:
    topics, ahead_m = config.topics, config.nav2.ahead_m
    names = {"cmd_vel": topics.cmd_vel, "goal_pose": topics.goal_pose}
    names |= {"stop_cmd_vel": topics.stop_cmd_vel, "nav2_lock": topics.nav2_lock}
    of_topics = dict[str, str]()
    for name, topic in names.items():
        if topic is not None and (other := of_topics.setdefault(topic.strip("/"), name)) != name:
            raise ConfigError(
                f"topics.{name} '{topic}' is topics.{other}, too; expected a topic for each: with "
                "Nav2, cmd_vel is what the robot's multiplexer (twist_mux) publishes, stop_cmd_vel "
                "an input of its own above Nav2's, and nav2_lock a lock"
            )
    if ahead_m > _LARGE_AHEAD_M and topics.nav2_lock is None:
        _LOG.warning(
            "nav2.ahead_m %g: so far Nav2 drives on where hypernav or its network dies; a lock of "
            "twist_mux with a timeout (topics.nav2_lock) stops it",
            ahead_m,
        )


@contextmanager
def opened_drive(
    drive: Drive, network: Ros2Network, config: Ros2Config
) -> Iterator[tuple[Robot, SensingRobot]]:
    """Take control of a robot; it stands still at the end of the block.

    Args:
        drive: Who drives it.
        network: Its network.
        config: Its topics, frames and limits, already checked by `check_drive`.

    Returns:
        The robot for a search to drive, and its sensors.

    Raises:
        ConfigError: The camera's pose is impossible.
        Nav2Error: Nav2 takes no goals.
        RosNetworkError: Its data does not arrive, or it does not stand still at the end.
        TopicChoiceError: No topic of its camera fits, or several do.
        TransformMissingError: A frame is missing.
    """
    sensors = Ros2Sensors(network, config)
    if drive == "nav2":
        with given_back(Nav2Robot(network, config, sensors)) as robot:
            yield robot, robot
    else:
        with given_back(Ros2Base(network, config, sensors)) as base:
            yield DrivenRobot(base, config.driving), base


class _Closes(Protocol):
    def close(self) -> None: ...


_RobotT = TypeVar("_RobotT", bound=_Closes)


@contextmanager
def given_back(robot: _RobotT) -> Iterator[_RobotT]:
    """Close a robot at the end of the block, without hiding an error of the block.

    Raises:
        RosNetworkError: The block ended without error, but the robot does not stand still.
    """
    try:
        yield robot
    except BaseException:
        try:
            robot.close()
        except RosNetworkError as error:
            _LOG.error("%s", error)
        raise
    robot.close()
