"""Goals for Nav2 as messages, and standstill as a goal at the origin of the robot's base."""

import math
import time
from collections.abc import Callable

from hypernav.core.geometry.transforms import Pose2, wrap_angle
from hypernav.robot.ros2.config import Ros2Config
from hypernav.robot.ros2.idl_types import Header, PoseStamped
from hypernav.robot.ros2.nav2.waiting import wait_for
from hypernav.robot.ros2.nav2.wheel_hold import WheelHold
from hypernav.robot.ros2.network import Publisher, Ros2Network
from hypernav.robot.ros2.poses import pose_message
from hypernav.robot.ros2.sensors import Ros2Sensors

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
