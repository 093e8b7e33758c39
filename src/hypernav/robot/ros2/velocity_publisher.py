"""Publishes velocities in the message type that the robot reads."""

from hypernav.robot.motion.velocity import Velocity
from hypernav.robot.ros2.config import Ros2Config
from hypernav.robot.ros2.idl_types import Header, Twist, TwistStamped, Vector3
from hypernav.robot.ros2.network import Publisher, Ros2Network
from hypernav.robot.ros2.poses import ros_time
from hypernav.robot.ros2.sensors import Ros2Sensors


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
        self._is_stamped = config.cmd_vel_type == "TwistStamped"
        self._publisher: Publisher[Twist | TwistStamped] = network.publisher(
            topic, TwistStamped if self._is_stamped else Twist
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
