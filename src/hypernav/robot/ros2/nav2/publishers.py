"""Who else publishes on the topics by which the wheels are held."""

import time
from collections.abc import Callable
from typing import Protocol

from hypernav.core.errors import Nav2Error
from hypernav.robot.ros2.config import TopicsConfig

_LOOK_S = 0.1


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
    for. A publisher that comes later goes unnoticed.

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
        time.sleep(_LOOK_S)
    for name, topic in held.items():
        _await(
            lambda count: count == 0,
            *(network, topic, timeout_s),
            lambda count, name=name, topic=topic: (
                f"{count} other publisher(s) on '{topic}' (topics.{name}), expected hypernav "
                "alone: by them Nav2 would drive while the robot is to stand. End them, such "
                f"as a `ros2 topic pub` that opened the lock; `ros2 topic info -v {topic}` names "
                "them"
            ),
        )
    _await(
        lambda count: count == 1,
        *(network, topics.cmd_vel, timeout_s),
        lambda count: (
            f"{count} publishers on '{topics.cmd_vel}' (topics.cmd_vel), expected one, the robot's "
            "velocity multiplexer: what others publish there reaches the base past it. Remap the "
            "last node of Nav2 that publishes velocities, and behavior_server, from cmd_vel to an "
            "input of twist_mux, and cmd_vel_out of twist_mux to this topic "
            f"(`ros2 topic info -v {topics.cmd_vel}` names the publishers; docs/ros2.md)"
        ),
    )


def _await(
    is_right: Callable[[int], bool],
    network: KnowsPublishers,
    topic: str,
    timeout_s: float,
    otherwise: Callable[[int], str],
) -> None:
    """Wait until a topic has the right number of publishers.

    Raises:
        Nav2Error: It does not get it.
    """
    until_s = time.monotonic() + timeout_s
    while not is_right(count := network.publishers(topic)):
        if time.monotonic() > until_s:
            raise Nav2Error(otherwise(count))
        time.sleep(_LOOK_S)
