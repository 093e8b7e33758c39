"""The base of a robot on a ROS 2 network, which drives only while its sensor data is fresh.

Velocities are published in the message type that the robot reads.
"""

import logging
import math
import time

import numpy as np

from hypernav.core.errors import RosNetworkError
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.robot.driving.base import STANDSTILL, DepthView, Velocity
from hypernav.robot.ros2.config import Ros2Config
from hypernav.robot.ros2.guarded_output import GuardedOutput
from hypernav.robot.ros2.idl_types import Header, Twist, TwistStamped, Vector3
from hypernav.robot.ros2.network import Publisher, Ros2Network
from hypernav.robot.ros2.outputs import ros_time
from hypernav.robot.ros2.sensing_robot import SensingRobot
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


_SAFETY_COLUMNS = 160


class Ros2Base(SensingRobot):
    """Wheels, odometry and camera: a `Base`.

    The robot stands still while images or odometry are not fresh.
    """

    def __init__(self, network: Ros2Network, config: Ros2Config, sensors: Ros2Sensors) -> None:
        """Take over a robot that stands still.

        Args:
            network: The robot's network.
            config: Names of topics, limits, body.
            sensors: The robot's sensors, already working.

        Raises:
            RosNetworkError: No fresh images arrive within the patience, or nobody reads the
                velocities.
            ConfigError: The camera's pose is impossible, for example because the floor's height is
                wrong.
        """
        super().__init__(config, sensors)
        self._halts = 0
        wheels = VelocityPublisher(config.topics.cmd_vel, network, config, sensors)
        wheels.await_wheels(config.timing.find_s)
        self._output = GuardedOutput(wheels.publish, STANDSTILL, is_safe=sensors.is_fresh)

    def close(self) -> None:
        """Stand still and let others drive.

        Raises:
            RosNetworkError: The robot does not stand still at the end.
        """
        self._output.close()

    def depth_view(self) -> DepthView:
        """The newest depth image, subsampled; waits if the last one is too old to drive by.

        It includes returns nearer than those that maps are made from. `halt` ends the wait, with an
        image without any return.

        Raises:
            RosNetworkError: None comes within the patience.
            RosMessageError: It is broken.
            TransformMissingError: The camera's pose is not known.
        """
        halts, sensors = self._halts, self.sensors
        pair = sensors.wait_for_pair(unless=lambda: self._halts != halts)
        every = max(self.camera.width // _SAFETY_COLUMNS, 1)
        camera = _coarse(self.camera, every)
        if pair is None:  # tf may not have the present pose, and this image is not used to drive
            nothing = np.zeros((camera.height, camera.width), dtype=np.float32)
            upright = self.embodiment.camera.camera_to_base
            return DepthView(nothing, camera, upright, sensors.robot_now_s, self.odometry())
        depth = np.ascontiguousarray(self.depth_of(pair)[::every, ::every])
        camera_to_base = sensors.camera_to_base(pair.stamp_s)
        robot = sensors.odometry(pair.stamp_s)
        return DepthView(depth, camera, camera_to_base, pair.stamp_s, robot)

    def drive(self, velocity: Velocity, seconds: float) -> None:
        """Drive with a velocity for a number of seconds, then return."""
        self._output.command(velocity)
        time.sleep(seconds)

    def halt(self) -> None:
        """Command the base to stand still at once; may be called from any thread."""
        self._halts += 1
        self._output.halt()


def _coarse(camera: PinholeCamera, every: int) -> PinholeCamera:
    """The camera model of an image of which every n-th pixel is kept."""
    return PinholeCamera(
        math.ceil(camera.width / every),
        math.ceil(camera.height / every),
        camera.fx / every,
        camera.fy / every,
        0.5 + (camera.cx - 0.5) / every,
        0.5 + (camera.cy - 0.5) / every,
    )
