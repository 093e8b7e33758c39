"""Goals for Nav2 as messages; standstill, and stopping the wheels while Nav2 drives.

Standstill is a goal at the origin of the robot's base. The wheels are stopped at once by inputs of
a velocity multiplexer, if the robot has one.
"""

import math
import time
from collections.abc import Callable
from typing import Protocol

from hypernav.core.errors import Nav2Error
from hypernav.core.geometry.transforms import Pose2, wrap_angle
from hypernav.robot.driving.base import STANDSTILL
from hypernav.robot.ros2.config import Ros2Config, TopicsConfig
from hypernav.robot.ros2.idl_types import Bool, Header, PoseStamped
from hypernav.robot.ros2.network import Publisher, Ros2Network
from hypernav.robot.ros2.outputs import pose_message
from hypernav.robot.ros2.sensors import Ros2Sensors
from hypernav.robot.ros2.velocity_base import VelocityPublisher

_LOOK_S = 0.1


def wait_for(missing: Callable[[], str | None], timeout_s: float) -> None:
    """Wait until nothing is missing.

    Args:
        missing: What is missing, in words that say what to do about it; None if nothing is.
        timeout_s: Longest wait, seconds.

    Raises:
        Nav2Error: Something is still missing; the message is that of `missing`.
    """
    until_s = time.monotonic() + timeout_s
    while (words := missing()) is not None:
        if time.monotonic() > until_s:
            raise Nav2Error(words)
        time.sleep(_LOOK_S)


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


class WheelHold:
    """Holds the wheels by a multiplexer (``twist_mux``) between Nav2 and the base.

    Nav2 stops only when it plans again. Until then an input with a priority above its own receives
    zero velocity. A lock stays open only while it is told so repeatedly: its timeout closes it if
    hypernav or its network dies. Both are optional; without them nothing is held.
    """

    def __init__(self, network: Ros2Network, config: Ros2Config, sensors: Ros2Sensors) -> None:
        """Announce the topics.

        Args:
            network: The robot's network.
            config: Names of the topics, and type of the velocity.
            sensors: The robot's sensors, which know its clock.

        Raises:
            RosNetworkError: A topic can't be written.
        """
        stop, lock = config.topics.stop_cmd_vel, config.topics.nav2_lock
        self._network, self._config = network, config
        self._stop = None if stop is None else VelocityPublisher(stop, network, config, sensors)
        self._lock: Publisher[Bool] | None = None if lock is None else network.publisher(lock, Bool)

    def await_multiplexer(self, timeout_s: float) -> None:
        """Wait until the multiplexer is running, and nothing bypasses it.

        Raises:
            Nav2Error: Nobody reads the topics that hold the wheels, or others publish on them.
        """
        wait_for(self._missing_reader, timeout_s)
        await_sole_command(self._network, self._config.topics, timeout_s)

    def hold(self) -> None:
        """Keep the wheels still; to be called repeatedly.

        Raises:
            RosNetworkError: The network doesn't take it.
        """
        try:
            if self._stop is not None:
                self._stop.publish(STANDSTILL)
        finally:
            self._say_locked(True)

    def let_go(self) -> None:
        """Let Nav2 drive for a moment; to be called repeatedly.

        Raises:
            RosNetworkError: The network doesn't take it.
        """
        self._say_locked(False)

    def _say_locked(self, is_locked: bool) -> None:
        if self._lock is not None:
            self._lock.publish(Bool(is_locked))

    def _missing_reader(self) -> str | None:
        """What to do about an input that the multiplexer doesn't read; None if it reads all."""
        topics, kind = self._config.topics, self._config.cmd_vel_type
        if self._stop is not None and not self._stop.has_reader():
            return (
                f"nobody reads '{topics.stop_cmd_vel}' (topics.stop_cmd_vel) as geometry_msgs/"
                f"{kind}, expected the robot's velocity multiplexer, which holds the wheels by it; "
                "is twist_mux running, with this input, and does it take this type (cmd_vel_type)?"
            )
        if self._lock is not None and not self._lock.has_reader():
            return (
                f"nobody reads '{topics.nav2_lock}' (topics.nav2_lock) as std_msgs/Bool, expected "
                "the robot's velocity multiplexer; is twist_mux running, with this lock?"
            )
        return None


_SAME_M, _SAME_RAD = 0.05, math.radians(3.0)
"""Difference below which a goal is not sent again: each new goal makes Nav2 plan again."""
_STAND_S = 0.2
"""Time between two goals to stand still, for a robot that still moves."""
_HERE = Pose2(0.0, 0.0, 0.0)


class Nav2Goals:
    """Publishes goals for ``bt_navigator``, each of which replaces the one before.

    Poses are given in the frame of the odometry, which doesn't jump, and published in the frame of
    the localisation if there is one; when a correction moves them there, they are published again.

    The goal to stand still is the origin of the robot's base frame, which Nav2 looks up itself: our
    odometry may be late, so that Nav2 would drive back to where the robot was.
    """

    def __init__(
        self,
        network: Ros2Network,
        config: Ros2Config,
        sensors: Ros2Sensors,
        *,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Announce the topic.

        Args:
            network: The robot's network.
            config: Names of the topic and of the frames.
            sensors: Poses of the robot and of its localisation.
            clock: Clock of this machine.
        """
        self._topic = config.topics.goal_pose
        self._frame = config.frames.map or config.frames.odom
        self._base = config.frames.base
        self._sensors, self._clock = sensors, clock
        self._publisher: Publisher[PoseStamped] = network.publisher(self._topic, PoseStamped)
        self._wheels = WheelHold(network, config, sensors)
        self._last: Pose2 | None = None
        self._stood_s = -math.inf

    def await_readers(self, timeout_s: float) -> None:
        """Wait until Nav2 reads the goals, and the multiplexer the topics that hold the wheels.

        Raises:
            Nav2Error: Nobody reads them, or others bypass the multiplexer.
        """
        wait_for(self._missing_reader, timeout_s)
        self._wheels.await_multiplexer(timeout_s)

    def send(self, goal: Pose2 | None) -> None:
        """Publish a goal if it has changed; None is standstill.

        Nav2 follows its old path until it plans again, by default once a second; only the
        multiplexer can stop it sooner, and is told with every call.

        Raises:
            RosNetworkError: The network doesn't take it.
        """
        if goal is None:
            try:
                self._wheels.hold()
            finally:  # each of the two may stop the robot if the other fails
                self._stand()
            return
        self._stood_s = -math.inf
        wanted = self._in_frame(goal)
        if self._last is None or not _is_same(wanted, self._last):
            self._publish(wanted, self._frame)
            self._last = wanted
        self._wheels.let_go()

    def _missing_reader(self) -> str | None:
        """What to do if nobody reads the goals; None if somebody does."""
        if self._publisher.has_reader():
            return None
        return (
            f"nobody reads '{self._topic}' as geometry_msgs/PoseStamped, expected Nav2's "
            "bt_navigator; is Nav2 running and configured (`ros2 lifecycle get /bt_navigator`), "
            "in this domain, and without a namespace (topics.goal_pose)?"
        )

    def _stand(self) -> None:
        if self._clock() - self._stood_s >= _STAND_S:
            self._last = None  # whatever comes next is new
            self._publish(_HERE, self._base)
            self._stood_s = self._clock()

    def _publish(self, pose: Pose2, frame: str) -> None:
        # A pose without a time is used with the newest transforms, so clocks need not agree.
        self._publisher.publish(pose_message(pose, Header(frame_id=frame)))

    def _in_frame(self, pose: Pose2) -> Pose2:
        found = self._sensors.odom_to_map().to_transform() @ pose.to_transform()
        x, y, _ = found.translation.tolist()
        return Pose2(x, y, found.yaw)


def _is_same(one: Pose2, other: Pose2) -> bool:
    turned = abs(wrap_angle(one.yaw - other.yaw))
    return one.distance_to(*other.xy) < _SAME_M and turned < _SAME_RAD
