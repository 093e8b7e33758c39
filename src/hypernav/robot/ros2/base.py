"""The base of a robot on a ROS 2 network: sensors, and a velocity that data must be fresh for."""

import math
import time

import numpy as np

from hypernav.core.geometry.camera import PinholeCamera
from hypernav.robot.driving.base import DepthView
from hypernav.robot.motion.velocity import STANDSTILL, Velocity
from hypernav.robot.ros2.config import Ros2Config
from hypernav.robot.ros2.guarded_output import GuardedOutput
from hypernav.robot.ros2.network import Ros2Network
from hypernav.robot.ros2.sensing_robot import SensingRobot
from hypernav.robot.ros2.sensors import Ros2Sensors
from hypernav.robot.ros2.velocity_publisher import VelocityPublisher

_SAFETY_COLUMNS = 160


class Ros2Base(SensingRobot):
    """Wheels, odometry and camera: a `Base`.

    While images or odometry are not fresh the robot stands, and goes on when they are again.
    """

    def __init__(self, network: Ros2Network, config: Ros2Config, sensors: Ros2Sensors) -> None:
        """Take over a robot that stands still.

        Args:
            network: The robot's network.
            config: Names of topics, limits, body.
            sensors: The robot's sensors, which work already.

        Raises:
            RosNetworkError: Their images are not fresh within the patience.
            ConfigError: No robot can have their camera: the floor's height is wrong, for example.
        """
        super().__init__(config, sensors)
        self._halts = 0
        wheels = VelocityPublisher(config.topics.cmd_vel, network, config, sensors)
        self._output = GuardedOutput(wheels.publish, STANDSTILL, is_safe=sensors.is_fresh)

    def close(self) -> None:
        """Stand still and let others drive.

        Raises:
            RosNetworkError: The robot doesn't stand at the end.
        """
        self._output.close()

    def depth_view(self) -> DepthView:
        """The newest depth image, coarser; waits for one where the last is too old to drive by.

        A halt ends the wait, by an image without any return.

        It has all returns, also those nearer than what maps are made from.

        Raises:
            RosNetworkError: None comes within the patience.
            RosMessageError: It is broken.
            TransformMissingError: The camera's pose is not known.
        """
        halts, sensors = self._halts, self.sensors
        pair = sensors.wait_for_pair(unless=lambda: self._halts != halts)
        every = max(self.camera.width // _SAFETY_COLUMNS, 1)
        camera = _coarse(self.camera, every)
        if pair is None:  # tf may know nothing of now, and nobody drives by it
            nothing = np.zeros((camera.height, camera.width), dtype=np.float32)
            upright = self.embodiment.camera.camera_to_base
            return DepthView(nothing, camera, upright, sensors.robot_now_s, self.odometry())
        depth = np.ascontiguousarray(self.depth_of(pair)[::every, ::every])
        camera_to_base = sensors.camera_to_base(pair.stamp_s)
        robot = sensors.odometry(pair.stamp_s)
        return DepthView(depth, camera, camera_to_base, pair.stamp_s, robot)

    def drive(self, velocity: Velocity, seconds: float) -> None:
        """Drive with a velocity, and come back after so many seconds."""
        self._output.command(velocity)
        time.sleep(seconds)

    def halt(self) -> None:
        """Command standstill at once; may be called from any thread."""
        self._halts += 1
        self._output.halt()


def _coarse(camera: PinholeCamera, every: int) -> PinholeCamera:
    """The camera of every n-th pixel of an image."""
    return PinholeCamera(
        math.ceil(camera.width / every),
        math.ceil(camera.height / every),
        camera.fx / every,
        camera.fy / every,
        0.5 + (camera.cx - 0.5) / every,
        0.5 + (camera.cy - 0.5) / every,
    )
