"""Who else publishes on the topics by which the wheels are held."""

import time
from typing import Protocol

from hypernav.robot.ros2.config import TopicsConfig
from hypernav.robot.ros2.nav2.waiting import wait_for

_SETTLE_S = 0.1


class KnowsPublishers(Protocol):
    """A network that knows who publishes."""

    @property
    def is_settled(self) -> bool:
        """Whether all publishers are known by now."""
        ...

    def publishers(self, topic: str) -> int:
        """Number of publishers that others have of a topic."""
        ...


def await_sole_command(network: KnowsPublishers, topics: TopicsConfig, timeout_s: float) -> None:
    """Wait until only the multiplexer commands the base, and only hypernav the multiplexer.

    Without a multiplexer (``stop_cmd_vel`` and ``nav2_lock`` are None) there is nothing to wait
    for. A publisher that appears later is not noticed.

    Args:
        network: The robot's network.
        topics: Names of the topics.
        timeout_s: Longest wait for a publisher to appear or to end, seconds.

    Raises:
        Nav2Error: Others publish where they would defeat a stop, or nobody commands the base.
    """
    ours = {"stop_cmd_vel": topics.stop_cmd_vel, "nav2_lock": topics.nav2_lock}
    held = {name: topic for name, topic in ours.items() if topic is not None}
    if not held:
        return
    while not network.is_settled:
        time.sleep(_SETTLE_S)
    for name, topic in held.items():
        wait_for(lambda name=name, topic=topic: _not_alone(network, name, topic), timeout_s)
    wait_for(lambda: _not_one(network, topics.cmd_vel), timeout_s)


def _not_alone(network: KnowsPublishers, name: str, topic: str) -> str | None:
    """What to do if others publish on a topic of ours; None if nobody does."""
    count = network.publishers(topic)
    if count == 0:
        return None
    return (
        f"{count} other publisher(s) on '{topic}' (topics.{name}), expected hypernav alone: "
        "Nav2 could drive while the robot is to stand still. End them, such as a `ros2 topic pub` "
        f"that opened the lock; `ros2 topic info -v {topic}` names them"
    )


def _not_one(network: KnowsPublishers, topic: str) -> str | None:
    """What to do unless exactly one publishes on the base's topic; None if so."""
    count = network.publishers(topic)
    if count == 1:
        return None
    return (
        f"{count} publishers on '{topic}' (topics.cmd_vel), expected one, the robot's velocity "
        "multiplexer: what others publish there bypasses it. Remap the last node of "
        "Nav2 that publishes velocities, and behavior_server, from cmd_vel to an input of "
        f"twist_mux, and cmd_vel_out of twist_mux to this topic (`ros2 topic info -v {topic}` "
        "names the publishers; docs/ros2.md)"
    )
