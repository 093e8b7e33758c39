"""Publishes velocities in the message type that the robot reads."""

import logging
import time

from hypernav.core.errors import RosNetworkError
from hypernav.robot.motion.velocity import Velocity
from hypernav.robot.ros2.config import Ros2Config
from hypernav.robot.ros2.idl_types import Header, Twist, TwistStamped, Vector3
from hypernav.robot.ros2.network import Publisher, Ros2Network
from hypernav.robot.ros2.poses import ros_time
from hypernav.robot.ros2.sensors import Ros2Sensors

_LOG = logging.getLogger(__name__)
_LOOK_S = 0.1


class VelocityPublisher:
    """Publishes velocities as ``Twist`` or ``TwistStamped``, as ``cmd_vel_type`` says."""

    def __init__(
        self, topic: str, network: Ros2Network, config: Ros2Config, sensors: Ros2Sensors
    ) -> None:
        """Announce a topic.

        Args:
            topic: ROS name of the topic.
            network: The robot's network.
            config: The type, and the frame of the base.
            sensors: The robot's sensors, which know its clock.

        Raises:
            RosNetworkError: The topic can't be written.
        """
        self._frame, self._sensors = config.frames.base, sensors
        self._topic, self._network, self._type = topic, network, config.cmd_vel_type
        self._is_stamped = config.cmd_vel_type == "TwistStamped"
        self._publisher: Publisher[Twist | TwistStamped] = network.publisher(
            topic, TwistStamped if self._is_stamped else Twist
        )

    def await_wheels(self, timeout_s: float) -> None:
        """Wait until somebody reads the velocities, and name whoever else publishes some.

        Args:
            timeout_s: Longest wait, seconds.

        Raises:
            RosNetworkError: Nobody reads them as this type.
        """
        until_s = time.monotonic() + timeout_s
        while not (self.has_reader() and self._network.is_settled):
            if time.monotonic() > until_s and not self.has_reader():
                others = ", ".join(self._network.read_as(self._topic))
                remedy = (
                    f"but it is read as {others}; set cmd_vel_type"
                    if others
                    else "so the robot would not move; does its driver run, and is topics.cmd_vel "
                    "its topic?"
                )
                raise RosNetworkError(
                    f"nobody reads '{self._topic}' as {self._type} (cmd_vel_type), {remedy}"
                )
            time.sleep(_LOOK_S)
        if (count := self._network.publishers(self._topic)) > 0:
            _LOG.warning(
                "%d other publisher(s) on '%s': while hypernav searches, nobody else may drive; "
                "`ros2 topic info -v %s` names them",
                count,
                self._topic,
                self._topic,
            )

    def publish(self, velocity: Velocity) -> None:
        """Send a velocity.

        Raises:
            RosNetworkError: The network doesn't take it.
        """
        twist = Twist(Vector3(velocity.linear_m_s), Vector3(z=velocity.angular_rad_s))
        if self._is_stamped:
            header = Header(ros_time(self._sensors.robot_now_s), self._frame)
            self._publisher.publish(TwistStamped(header, twist))
        else:
            self._publisher.publish(twist)

    def has_reader(self) -> bool:
        """Whether somebody reads velocities of this type."""
        return self._publisher.has_reader()
